#include "harness/report/format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace raystudy {

TableFormat table_format(std::string_view name) {
  static const std::vector<std::pair<std::string, TableFormat>> all{{"markdown", TableFormat::markdown},
                                                                    {"latex", TableFormat::latex},
                                                                    {"csv", TableFormat::csv},
                                                                    {"csv-wide", TableFormat::csv_wide}};
  std::vector<std::string> names;
  for (const auto& [known, format] : all) {
    if (known == name) return format;
    names.push_back(known);
  }
  throw Error(Diagnostic{{},
                         fmt::format("there is no table format '{}'", name),
                         "one of markdown, latex, csv, csv-wide",
                         nearest_name(name, names)});
}

void write_tables(const std::vector<ReportTable>& tables, TableFormat format, std::ostream& out) {
  switch (format) {
    case TableFormat::markdown: return write_markdown(tables, out);
    case TableFormat::latex: return write_latex(tables, out);
    case TableFormat::csv: return write_csv(tables, out);
    case TableFormat::csv_wide: return write_csv_wide(tables, out);
  }
}

Notes::Notes(const ReportTable& table) {
  for (const ReportRow& row : table.rows) {
    for (const ReportCell& cell : row.cells) {
      if (!cell.reason.empty() && number(cell) == 0) texts_.push_back(cell.reason);
    }
  }
}

std::size_t Notes::number(const ReportCell& cell) const {
  const auto found = std::find(texts_.begin(), texts_.end(), cell.reason);
  return found == texts_.end() ? 0 : static_cast<std::size_t>(found - texts_.begin()) + 1;
}

namespace {

/// Three digits and a prefix: "12.3 k".
std::string with_prefix(double value) {
  static constexpr std::array<const char*, 5> prefixes{"", " k", " M", " G", " T"};
  std::size_t prefix = 0;
  // 999.5 would be shown as 1000.
  for (; value >= 999.5 && prefix + 1 < prefixes.size(); ++prefix) value /= 1000;
  const int decimals = value >= 99.95 || (prefix == 0 && value == std::floor(value)) ? 0 : value >= 9.995 ? 1 : 2;
  return fmt::format("{:.{}f}{}", value, decimals, prefixes.at(prefix));
}

/// "12.3 k to 1.20 M", "from 1.20 M".
std::string shown_range(double first, double last) {
  if (std::isinf(last)) return first == 0 ? "all" : fmt::format("from {}", with_prefix(first));
  return first == 0 ? fmt::format("up to {}", with_prefix(last)) : fmt::format("{} to {}", with_prefix(first), with_prefix(last));
}

}  // namespace

std::string shown_value(const ReportCell& cell, int decimals) {
  if (cell.ours && cell.range_end) return shown_range(cell.ours->value, *cell.range_end);
  if (!cell.ours) return cell.absence == "none" || cell.absence.empty() ? "–" : cell.absence;
  std::string text = fmt::format("{:.{}f}", cell.ours->value, decimals);
  if (cell.shows_error && cell.ours->interval) {
    return text + fmt::format(" ± {:.{}f}", cell.ours->interval->high - cell.ours->value, decimals);
  }
  if (const auto& i = cell.ours->interval) text += fmt::format(" [{:.{}f}, {:.{}f}]", i->low, decimals, i->high, decimals);
  return text;
}

namespace {

std::string with_unit(const ReportColumn& column) {
  return column.unit.empty() ? column.label : fmt::format("{} [{}]", column.label, column.unit);
}

bool is_judged(const ReportTable& table) { return table.has_published() || table.has_targets(); }

/// A cell with the column it is shown by.
struct ShownCell {
  const ReportCell* cell = nullptr;
  const ReportColumn* column = nullptr;
};

/// "match"; of a target "reached (≥ 1.15)".
std::string verdict_text(const ReportCell& cell) {
  const std::string_view name = verdict_name(cell.verdict);
  return cell.target ? fmt::format("{}{}{}", name, name.empty() ? "" : ": ", cell.target->text()) : std::string(name);
}

NotedLines lines_of(const std::string& label, const std::vector<ShownCell>& cells, bool judged, const Notes& notes) {
  using Line = std::vector<NotedText>;
  Line published{{"", 0}, {"published", 0}};
  Line ours{{"", 0}};
  Line ratio{{"", 0}, {"ratio", 0}};
  Line verdict{{"", 0}, {"verdict", 0}};
  if (judged) ours.push_back({"ours", 0});
  bool any_published = false;
  bool any_ratio = false;
  bool any_target = false;
  for (const auto& [cell, column] : cells) {
    const bool has_verdict = cell->verdict != Verdict::none;
    const std::size_t note = notes.number(*cell);
    published.push_back({cell->published ? cell->published->text : "", 0});
    ours.push_back({shown_value(*cell, column->decimals), has_verdict ? 0 : note});
    ratio.push_back({cell->ratio ? fmt::format("{:.3f}", *cell->ratio) : "", 0});
    verdict.push_back({verdict_text(*cell), has_verdict ? note : 0});
    any_published = any_published || cell->published;
    any_ratio = any_ratio || cell->ratio;
    any_target = any_target || cell->target;
  }
  NotedLines lines;
  if (any_published) lines.push_back(std::move(published));
  lines.push_back(std::move(ours));
  if (any_ratio) lines.push_back(std::move(ratio));
  if (any_ratio || any_target) lines.push_back(std::move(verdict));
  lines.front().front().text = label;
  return lines;
}

}  // namespace

std::size_t text_columns(const ReportTable& table) { return is_judged(table) ? 2 : 1; }

std::vector<std::string> head_line(const ReportTable& table) {
  std::vector<std::string> line{table.row_heading};
  if (is_judged(table)) line.emplace_back("");
  if (table.transposed) {
    for (const ReportRow& row : table.rows) line.push_back(row.label);
  } else {
    for (const ReportColumn& column : table.columns) line.push_back(with_unit(column));
  }
  return line;
}

std::vector<NotedLines> table_lines(const ReportTable& table, const Notes& notes) {
  std::vector<NotedLines> all;
  const bool judged = is_judged(table);
  if (table.transposed) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      std::vector<ShownCell> cells;
      for (const ReportRow& row : table.rows) cells.push_back({&row.cells[i], &table.columns[i]});
      all.push_back(lines_of(with_unit(table.columns[i]), cells, judged, notes));
    }
    return all;
  }
  for (const ReportRow& row : table.rows) {
    std::vector<ShownCell> cells;
    for (std::size_t i = 0; i < row.cells.size(); ++i) cells.push_back({&row.cells[i], &table.columns[i]});
    all.push_back(lines_of(row.label, cells, judged, notes));
  }
  return all;
}

std::vector<std::string> published_lines(const ReportTable& table) {
  std::vector<std::string> lines;
  for (const ReportColumn& column : table.columns) {
    if (column.published == nullptr) continue;
    const PublishedColumn& p = *column.published;
    std::string held = fmt::format("match within {}", p.tolerance.text(p.unit));
    if (p.compared_by == ComparedBy::trend) held = "only the direction is compared";
    if (p.compared_by == ComparedBy::nothing) held = "shown only";
    lines.push_back(fmt::format("{}: {}, {}; {}", column.label, p.source, value_class_name(p.value_class), held));
  }
  return lines;
}

std::string_view verdict_legend() {
  return "match: within the stated tolerance. trend: outside it, with the published order of methods and sign of change. "
         "differs: "
         "neither. not comparable: not the same thing was measured, for the reason given.";
}

std::string_view target_legend() {
  return "reached, missed: whether the median meets the target. The best of several methods is the one of the best median; the "
         "interval "
         "is that of the two compared, and leaves out that they were chosen.";
}

}  // namespace raystudy
