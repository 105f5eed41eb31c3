#include "harness/report/format.h"

#include <fmt/format.h>

#include <algorithm>

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

std::string shown_value(const ReportCell& cell, int decimals) {
  if (!cell.ours) return cell.absence == "none" || cell.absence.empty() ? "–" : cell.absence;
  std::string text = fmt::format("{:.{}f}", cell.ours->value, decimals);
  if (const auto& i = cell.ours->interval) text += fmt::format(" [{:.{}f}, {:.{}f}]", i->low, decimals, i->high, decimals);
  return text;
}

std::vector<std::string> head_line(const ReportTable& table) {
  std::vector<std::string> line{table.row_heading};
  if (table.has_published()) line.emplace_back("");
  for (const ReportColumn& column : table.columns) {
    line.push_back(column.unit.empty() ? column.label : fmt::format("{} [{}]", column.label, column.unit));
  }
  return line;
}

std::vector<std::vector<NotedText>> row_lines(const ReportTable& table, const ReportRow& row, const Notes& notes) {
  using Line = std::vector<NotedText>;
  const bool compared = table.has_published();
  Line published{{"", 0}, {"published", 0}};
  Line ours{{"", 0}};
  Line ratio{{"", 0}, {"ratio", 0}};
  Line verdict{{"", 0}, {"verdict", 0}};
  if (compared) ours.push_back({"ours", 0});
  bool any_published = false;
  bool any_ratio = false;
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    const ReportCell& cell = row.cells[i];
    const bool judged = cell.verdict != Verdict::none;
    const std::size_t note = notes.number(cell);
    published.push_back({cell.published ? cell.published->text : "", 0});
    ours.push_back({shown_value(cell, table.columns[i].decimals), judged ? 0 : note});
    ratio.push_back({cell.ratio ? fmt::format("{:.3f}", *cell.ratio) : "", 0});
    verdict.push_back({std::string(verdict_name(cell.verdict)), judged ? note : 0});
    any_published = any_published || cell.published;
    any_ratio = any_ratio || cell.ratio;
  }
  std::vector<Line> lines;
  if (any_published) lines.push_back(std::move(published));
  lines.push_back(std::move(ours));
  if (any_ratio) lines.insert(lines.end(), {std::move(ratio), std::move(verdict)});
  lines.front().front().text = row.label;
  return lines;
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

}  // namespace raystudy
