#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "harness/report/table.h"

namespace raystudy {

/// markdown: for the terminal and the web. latex: booktabs, a `table` environment to \input. csv: long form, one line a cell.
/// csv_wide: one line a row.
enum class TableFormat : unsigned char { markdown, latex, csv, csv_wide };
/// "markdown", "latex", "csv" or "csv-wide"; throws Error with the nearest name.
[[nodiscard]] TableFormat table_format(std::string_view name);

void write_markdown(const std::vector<ReportTable>& tables, std::ostream& out);
/// Needs the packages booktabs and, before LaTeX 2018, inputenc with utf8.
void write_latex(const std::vector<ReportTable>& tables, std::ostream& out);
/// RFC 4180: the header `table,row,column,class,unit,published,target,ours,low,high,ratio,verdict,reason`, then one line a cell.
/// Numbers have all their digits; published ones the paper's. Of a range `ours` is where it begins; of a slope `low` and
/// `high` are a standard error away. Fields without a value are
/// empty.
void write_csv(const std::vector<ReportTable>& tables, std::ostream& out);
/// RFC 4180: per table a header `row,COLUMN,…` with COLUMN.published, .low, .high, .ratio and .verdict where there are such; an
/// empty line between tables.
void write_csv_wide(const std::vector<ReportTable>& tables, std::ostream& out);
void write_tables(const std::vector<ReportTable>& tables, TableFormat format, std::ostream& out);

// What the formats share.

/// Reasons of a table, numbered in the order in which they are met, each once.
class Notes {
 public:
  explicit Notes(const ReportTable& table);
  /// From 1; 0 where the cell has no reason.
  [[nodiscard]] std::size_t number(const ReportCell& cell) const;
  [[nodiscard]] const std::vector<std::string>& texts() const { return texts_; }

 private:
  std::vector<std::string> texts_;
};

/// A text with the number of its note; 0: none.
struct NotedText {
  std::string text;
  std::size_t note = 0;
};

/// The lines of one row, or in a transposed table of one column, as texts; its label first.
using NotedLines = std::vector<std::vector<NotedText>>;

/// A table without published values and targets has one line a row. One with them has up to four, one below the other under a
/// second heading, so that a table of many columns stays readable: published, ours, ratio, verdict.
[[nodiscard]] std::vector<NotedLines> table_lines(const ReportTable& table, const Notes& notes);
/// How many columns of text stand before the numbers.
[[nodiscard]] std::size_t text_columns(const ReportTable& table);
/// The headings over those lines, units in brackets.
[[nodiscard]] std::vector<std::string> head_line(const ReportTable& table);

/// "0.52 [0.50, 0.55]"; a range as "12.3 k to 1.20 M", a slope as "1.05 ± 0.02"; what is absent as "not run", "failed", "not
/// installed", "never" or "–".
[[nodiscard]] std::string shown_value(const ReportCell& cell, int decimals);
/// "cost: Table 1, p. 17; match within 1 % of the published value", a line for each published column.
[[nodiscard]] std::vector<std::string> published_lines(const ReportTable& table);
/// What the verdicts over published values mean, in one line, and those over targets.
[[nodiscard]] std::string_view verdict_legend();
[[nodiscard]] std::string_view target_legend();

}  // namespace raystudy
