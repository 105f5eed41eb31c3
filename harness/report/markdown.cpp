#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "harness/report/format.h"

namespace raystudy {
namespace {

/// Columns on a terminal: the number of code points, which is right for every letter that tables here use.
std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

/// A grid of texts, padded so that the bars line up.
class Grid {
 public:
  /// The first `left` columns are text, the others numbers.
  explicit Grid(std::size_t left) : left_(left) {}
  void add(std::vector<std::string> line) {
    for (std::string& cell : line) cell = escaped(cell);
    widths_.resize(std::max(widths_.size(), line.size()), 3);
    for (std::size_t i = 0; i < line.size(); ++i) widths_[i] = std::max(widths_[i], width(line[i]));
    lines_.push_back(std::move(line));
  }
  void write(std::ostream& out) const {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      write_line(lines_[i], out);
      if (i == 0) write_rule(out);
    }
  }

 private:
  void write_line(const std::vector<std::string>& line, std::ostream& out) const {
    out << '|';
    for (std::size_t i = 0; i < line.size(); ++i) {
      const std::string space(widths_[i] - width(line[i]), ' ');
      out << ' ' << (i < left_ ? line[i] + space : space + line[i]) << " |";
    }
    out << '\n';
  }
  void write_rule(std::ostream& out) const {
    out << '|';
    for (std::size_t i = 0; i < widths_.size(); ++i) {
      out << (i < left_ ? ':' : '-') << std::string(widths_[i], '-') << (i < left_ ? "-|" : ":|");
    }
    out << '\n';
  }

  std::size_t left_;
  std::vector<std::size_t> widths_;
  std::vector<std::vector<std::string>> lines_;
};

std::vector<std::string> marked(const std::vector<NotedText>& line) {
  std::vector<std::string> texts;
  texts.reserve(line.size());
  for (const NotedText& t : line) texts.push_back(t.note == 0 ? t.text : fmt::format("{} ({})", t.text, t.note));
  return texts;
}

void write_table(const ReportTable& table, std::ostream& out) {
  const Notes notes(table);
  const bool compared = table.has_published();
  fmt::format_to(std::ostreambuf_iterator<char>(out), "### {}{}{}\n\n", table.name, table.caption.empty() ? "" : ": ",
                 table.caption);
  Grid grid(text_columns(table));
  grid.add(head_line(table));
  for (const NotedLines& lines : table_lines(table, notes)) {
    for (const auto& line : lines) grid.add(marked(line));
  }
  grid.write(out);
  out << '\n';
  for (std::size_t i = 0; i < notes.texts().size(); ++i) out << '(' << i + 1 << ") " << escaped(notes.texts()[i]) << "  \n";
  fmt::format_to(std::ostreambuf_iterator<char>(out), "Cost model: c_T = {:g}, c_I = {:g}, heuristic {}  \n", table.traversal,
                 table.intersection, table.heuristic);
  for (const std::string& remark : table.remarks) out << remark << "  \n";
  if (table.has_targets()) out << "Targets: " << target_legend() << '\n';
  if (!compared) return;
  out << "Published: " << table.citation << "  \n";
  for (const std::string& line : published_lines(table)) out << "- " << line << '\n';
  out << "\nVerdicts: " << verdict_legend() << '\n';
}

}  // namespace

void write_markdown(const std::vector<ReportTable>& tables, std::ostream& out) {
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (i > 0) out << '\n';
    write_table(tables[i], out);
  }
}

}  // namespace raystudy
