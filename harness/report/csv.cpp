#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "harness/report/format.h"

namespace raystudy {
namespace {

/// RFC 4180: a field with a comma, a quote or a line break stands in quotes, its own quotes doubled.
std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

void write_record(const std::vector<std::string>& fields, std::ostream& out) {
  for (std::size_t i = 0; i < fields.size(); ++i) out << (i == 0 ? "" : ",") << csv_field(fields[i]);
  out << "\r\n";
}

std::string number(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; }
std::string ours(const ReportCell& cell) { return cell.ours ? number(cell.ours->value) : ""; }
std::string low(const ReportCell& cell) { return cell.ours && cell.ours->interval ? number(cell.ours->interval->low) : ""; }
std::string high(const ReportCell& cell) { return cell.ours && cell.ours->interval ? number(cell.ours->interval->high) : ""; }
std::string published(const ReportCell& cell) { return cell.published ? cell.published->text : ""; }
std::string verdict(const ReportCell& cell) { return std::string(verdict_name(cell.verdict)); }

/// Why there is no value, in words a reader of one line understands.
std::string reason(const ReportCell& cell) { return cell.reason.empty() && !cell.ours ? cell.absence : cell.reason; }

void write_wide(const ReportTable& table, std::ostream& out) {
  const auto any_interval = [&](std::size_t i) {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [i](const ReportRow& row) { return row.cells[i].ours && row.cells[i].ours->interval; });
  };
  const auto any_target = [&](std::size_t i) {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [i](const ReportRow& row) { return row.cells[i].target.has_value(); });
  };
  std::vector<std::string> head{"row"};
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const std::string& name = table.columns[i].name;
    if (table.columns[i].published != nullptr) head.push_back(name + ".published");
    head.push_back(name);
    if (any_interval(i)) head.insert(head.end(), {name + ".low", name + ".high"});
    if (table.columns[i].published != nullptr) head.push_back(name + ".ratio");
    if (table.columns[i].published != nullptr || any_target(i)) head.push_back(name + ".verdict");
  }
  write_record(head, out);
  for (const ReportRow& row : table.rows) {
    std::vector<std::string> fields{row.label};
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const ReportCell& cell = row.cells[i];
      if (table.columns[i].published != nullptr) fields.push_back(published(cell));
      fields.push_back(ours(cell));
      if (any_interval(i)) fields.insert(fields.end(), {low(cell), high(cell)});
      if (table.columns[i].published != nullptr) fields.push_back(number(cell.ratio));
      if (table.columns[i].published != nullptr || any_target(i)) fields.push_back(verdict(cell));
    }
    write_record(fields, out);
  }
}

}  // namespace

void write_csv(const std::vector<ReportTable>& tables, std::ostream& out) {
  write_record(
      {"table", "row", "column", "class", "unit", "published", "target", "ours", "low", "high", "ratio", "verdict", "reason"},
      out);
  for (const ReportTable& table : tables) {
    for (const ReportRow& row : table.rows) {
      for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const ReportCell& cell = row.cells[i];
        const std::string value_class = cell.value_class ? std::string(value_class_name(*cell.value_class)) : "";
        write_record({table.name, row.label, table.columns[i].name, value_class, table.columns[i].unit, published(cell),
                      cell.target ? cell.target->text() : "", ours(cell), low(cell), high(cell), number(cell.ratio),
                      verdict(cell), reason(cell)},
                     out);
      }
    }
  }
}

void write_csv_wide(const std::vector<ReportTable>& tables, std::ostream& out) {
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (i > 0) out << "\r\n";
    write_wide(tables[i], out);
  }
}

}  // namespace raystudy
