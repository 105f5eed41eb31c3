#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ostream>
#include <utility>

#include "harness/report/format.h"

namespace raystudy {
namespace {

/// Characters that LaTeX reads as commands, and those beyond its default fonts.
std::string escaped(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 22> table{{{"\\", "\\textbackslash{}"},
                                                                                        {"&", "\\&"},
                                                                                        {"%", "\\%"},
                                                                                        {"$", "\\$"},
                                                                                        {"#", "\\#"},
                                                                                        {"_", "\\_"},
                                                                                        {"{", "\\{"},
                                                                                        {"}", "\\}"},
                                                                                        {"~", "\\textasciitilde{}"},
                                                                                        {"^", "\\textasciicircum{}"},
                                                                                        {"<", "\\textless{}"},
                                                                                        {">", "\\textgreater{}"},
                                                                                        {"|", "\\textbar{}"},
                                                                                        {"\"", "\\textquotedbl{}"},
                                                                                        {"–", "--"},
                                                                                        {"−", "$-$"},
                                                                                        {"×", "$\\times$"},
                                                                                        {"µ", "$\\mu$"},
                                                                                        {"·", "$\\cdot$"},
                                                                                        {"≥", "$\\ge$"},
                                                                                        {"±", "$\\pm$"},
                                                                                        {"≤", "$\\le$"}}};
  std::string out;
  if (text.starts_with('[')) out = "{}";  // after a line's end a bracket would be read as the height of the gap
  while (!text.empty()) {
    const auto* found =
        std::find_if(table.begin(), table.end(), [&](const auto& entry) { return text.starts_with(entry.first); });
    if (found != table.end()) {
      out += found->second;
      text.remove_prefix(found->first.size());
    } else {
      out += text.front() == '\n' ? ' ' : text.front();
      text.remove_prefix(1);
    }
  }
  return out;
}

std::string marked(const NotedText& t) {
  return t.note == 0 ? escaped(t.text) : fmt::format("{}\\textsuperscript{{{}}}", escaped(t.text), t.note);
}

void write_line(const std::vector<NotedText>& line, std::ostream& out) {
  out << "    ";
  for (std::size_t i = 0; i < line.size(); ++i) out << (i == 0 ? "" : " & ") << marked(line[i]);
  out << " \\\\\n";
}

void write_footer(const ReportTable& table, const Notes& notes, std::ostream& out) {
  out << "  \\par\\smallskip\\footnotesize\\raggedright\n";
  for (std::size_t i = 0; i < notes.texts().size(); ++i) {
    out << "  \\textsuperscript{" << i + 1 << "} " << escaped(notes.texts()[i]) << ".\\\\\n";
  }
  out << fmt::format("  Cost model: $c_T = {:g}$, $c_I = {:g}$, heuristic {}.", table.traversal, table.intersection,
                     escaped(table.heuristic));
  for (const std::string& remark : table.remarks) out << "\\\\\n  " << escaped(remark) << '.';
  if (table.has_targets()) out << "\\\\\n  Targets: " << escaped(target_legend());
  if (table.has_published()) out << "\\\\\n  Published: " << escaped(table.citation) << '.';
  for (const std::string& line : published_lines(table)) out << "\\\\\n  " << escaped(line) << '.';
  out << '\n';
}

void write_table(const ReportTable& table, std::ostream& out) {
  const Notes notes(table);
  const std::size_t texts = text_columns(table);
  out << "\\begin{table}\n  \\centering\n";
  out << "  \\caption{" << escaped(table.caption.empty() ? table.name : table.caption) << "}\n";
  std::string label = table.name;
  std::replace(label.begin(), label.end(), '/', ':');
  out << "  \\label{tab:" << label << "}\n";
  out << "  \\begin{tabular}{" << std::string(texts, 'l')
      << std::string(table.transposed ? table.rows.size() : table.columns.size(), 'r') << "}\n    \\toprule\n";
  std::vector<NotedText> head;
  for (std::string& text : head_line(table)) head.push_back({std::move(text), 0});
  write_line(head, out);
  out << "    \\midrule\n";
  const std::vector<NotedLines> rows = table_lines(table, notes);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && texts > 1) out << "    \\addlinespace\n";
    for (const auto& line : rows[i]) write_line(line, out);
  }
  out << "    \\bottomrule\n  \\end{tabular}\n";
  write_footer(table, notes, out);
  out << "\\end{table}\n";
}

}  // namespace

void write_latex(const std::vector<ReportTable>& tables, std::ostream& out) {
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (i > 0) out << '\n';
    write_table(tables[i], out);
  }
}

}  // namespace raystudy
