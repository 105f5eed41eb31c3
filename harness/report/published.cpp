#include "harness/report/published.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "harness/base/yaml.h"

namespace raystudy {
namespace {

template <class T>
using Choices = std::vector<std::pair<std::string, T>>;

const Choices<Comparability> comparabilities{{"same", Comparability::same},
                                             {"close-variant", Comparability::close_variant},
                                             {"variant", Comparability::variant},
                                             {"unverified", Comparability::unverified}};
const Choices<ComparedBy> comparisons{
    {"value", ComparedBy::value}, {"trend", ComparedBy::trend}, {"nothing", ComparedBy::nothing}};
const Choices<PublishedRows> row_kinds{
    {"scene", PublishedRows::scene}, {"method", PublishedRows::method}, {"claim", PublishedRows::claim}};
const Choices<ValueClass> classes{{"exact", ValueClass::exact}, {"ratio", ValueClass::ratio}, {"absolute", ValueClass::absolute}};

/// Walks the YAML tree and keeps every diagnostic.
class Reader {
 public:
  Reader(Published& out, std::vector<Diagnostic> problems) : out_(out), problems_(std::move(problems)) {}

  void read(const YamlNode& root) {
    check_keys(root, "the file", {"citation", "scenes", "tables"}, {"citation", "scenes", "tables"});
    out_.citation = text(root, "citation");
    if (const YamlNode* scenes = root.find("scenes")) read_scenes(*scenes);
    if (const YamlNode* tables = root.find("tables")) read_tables(*tables);
  }
  void finish() {
    std::stable_sort(problems_.begin(), problems_.end(), [](const Diagnostic& a, const Diagnostic& b) {
      return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
    });
    if (!problems_.empty()) throw Error(problems_);
  }

 private:
  void problem(const SourceLocation& where, std::string message, std::string expected = {}, std::string nearest = {}) {
    problems_.push_back({where, std::move(message), std::move(expected), std::move(nearest)});
  }

  bool check_map(const YamlNode& node, const std::string& what, const std::string& expected) {
    if (!node.is_map()) problem(node.where, fmt::format("{} is {}", what, described(node)), expected);
    return node.is_map();
  }
  void check_keys(const YamlNode& node, const std::string& what, const std::vector<std::string>& allowed,
                  const std::vector<std::string>& needed) {
    if (!check_map(node, what, fmt::format("the keys {}", fmt::join(allowed, ", ")))) return;
    for (const YamlEntry& entry : node.entries) {
      if (std::find(allowed.begin(), allowed.end(), entry.key) != allowed.end()) continue;
      problem(entry.where, fmt::format("unknown key '{}' in {}", entry.key, what),
              fmt::format("one of {}", fmt::join(allowed, ", ")), nearest_name(entry.key, allowed));
    }
    require(node, needed, what);
  }
  void require(const YamlNode& node, const std::vector<std::string>& needed, const std::string& what) {
    for (const std::string& key : needed) {
      if (node.is_map() && node.find(key) == nullptr) problem(node.where, fmt::format("{} has no '{}'", what, key));
    }
  }
  std::string text(const YamlNode& node, const std::string& key) {
    const YamlNode* found = node.find(key);
    if (found == nullptr) return {};
    if (!found->is_scalar()) problem(found->where, fmt::format("'{}' is {}", key, described(*found)), "a text");
    return found->text;
  }
  template <class T>
  T choice(const YamlNode& node, const std::string& key, const Choices<T>& choices) {
    const YamlNode* found = node.find(key);
    if (found == nullptr) return choices.front().second;
    std::vector<std::string> names;
    for (const auto& [name, meaning] : choices) {
      if (name == found->text) return meaning;
      names.push_back(name);
    }
    problem(found->where, fmt::format("'{}' is {}", key, described(*found)), fmt::format("one of {}", fmt::join(names, ", ")),
            nearest_name(found->text, names));
    return choices.front().second;
  }
  std::optional<double> number(const YamlNode& node, const std::string& what) {
    double value = 0;
    const char* const end = node.text.data() + node.text.size();
    const auto [stop, error] = std::from_chars(node.text.data(), end, value);
    if (node.is_scalar() && node.plain && error == std::errc{} && stop == end && std::isfinite(value)) return value;
    problem(node.where, fmt::format("{} is {}", what, described(node)), "a number");
    return {};
  }

  void read_scenes(const YamlNode& node) {
    if (!check_map(node, "'scenes'", "the paper's scenes by name")) return;
    for (const YamlEntry& entry : node.entries) {
      const YamlNode& at = *entry.value;
      const std::string what = fmt::format("scene '{}'", entry.key);
      check_keys(at, what, {"ours", "comparability", "reason"}, {});
      PublishedScene scene{entry.key, text(at, "ours"), choice(at, "comparability", comparabilities), text(at, "reason")};
      if (scene.comparability != Comparability::unverified) require(at, {"ours"}, what);
      if (scene.comparability != Comparability::same) require(at, {"reason"}, what);
      if (const PublishedScene* other = out_.scene_of(scene.ours)) {
        problem(at.where, fmt::format("scenes '{}' and '{}' are both our '{}'", other->name, entry.key, scene.ours));
      }
      out_.scenes.push_back(std::move(scene));
    }
  }

  void read_tables(const YamlNode& node) {
    if (!check_map(node, "'tables'", "the paper's tables by name")) return;
    for (const YamlEntry& entry : node.entries) read_table(entry.key, *entry.value);
  }

  void read_table(const std::string& name, const YamlNode& node) {
    const std::string what = fmt::format("table '{}'", name);
    check_keys(node, what, {"source", "rows", "columns", "values"}, {"source", "columns", "values"});
    const std::size_t first = out_.columns.size();
    const YamlNode* columns = node.find("columns");
    if (columns == nullptr) return;
    if (!columns->is_list()) {
      problem(columns->where, fmt::format("'columns' of {} is {}", what, described(*columns)), "a list of columns");
      return;
    }
    for (const auto& item : columns->items) {
      PublishedColumn column = read_column(*item, name);
      column.rows = choice(node, "rows", row_kinds);
      if (column.source.empty()) column.source = text(node, "source");
      if (out_.find(column.key()) != nullptr) problem(item->where, fmt::format("duplicate column '{}' in {}", column.name, what));
      out_.columns.push_back(std::move(column));
    }
    if (const YamlNode* values = node.find("values")) read_values(*values, what, first);
  }

  PublishedColumn read_column(const YamlNode& node, const std::string& table) {
    check_keys(node, fmt::format("a column of table '{}'", table),
               {"name", "what", "unit", "class", "compare", "reason", "tolerance", "baseline", "source"},
               {"name", "what", "unit", "class"});
    PublishedColumn column;
    column.table = table;
    column.name = text(node, "name");
    column.what = text(node, "what");
    column.unit = text(node, "unit");
    column.source = text(node, "source");
    column.reason = text(node, "reason");
    column.value_class = choice(node, "class", classes);
    column.compared_by = choice(node, "compare", comparisons);
    if (const YamlNode* baseline = node.find("baseline")) column.baseline = number(*baseline, "'baseline'");
    if (column.compared_by == ComparedBy::value) {
      require(node, {"tolerance"}, fmt::format("column '{}', which is compared by value,", column.name));
      if (const YamlNode* tolerance = node.find("tolerance")) column.tolerance = read_tolerance(*tolerance);
      if (column.value_class == ValueClass::absolute) {
        problem(node.where, fmt::format("column '{}' is absolute and compared by value", column.name),
                "'compare: trend' or 'compare: nothing': an absolute number belongs to its machine");
      }
    } else {
      require(node, {"reason"}, fmt::format("column '{}', which is not compared by value,", column.name));
    }
    return column;
  }

  Tolerance read_tolerance(const YamlNode& node) {
    check_keys(node, "'tolerance'", {"relative", "absolute"}, {});
    Tolerance tolerance;
    if (!node.is_map() || node.entries.size() != 1) {
      if (node.is_map()) problem(node.where, "'tolerance' needs exactly one of 'relative' and 'absolute'");
      return tolerance;
    }
    const YamlEntry& entry = node.entries.front();
    tolerance.relative = entry.key == "relative";
    tolerance.amount = number(*entry.value, fmt::format("'{}'", entry.key)).value_or(0);
    if (tolerance.amount < 0) {
      problem(entry.value->where, fmt::format("'{}' is {}", entry.key, tolerance.amount), "a number of at least 0");
    }
    return tolerance;
  }

  void read_values(const YamlNode& node, const std::string& what, std::size_t first) {
    if (!check_map(node, fmt::format("'values' of {}", what), "rows by name")) return;
    const std::size_t count = out_.columns.size() - first;
    for (const YamlEntry& entry : node.entries) {
      check_row(entry, what, first);
      const YamlNode& row = *entry.value;
      if (!row.is_list() || row.items.size() != count) {
        problem(row.where, fmt::format("row '{}' of {} has {} values", entry.key, what, row.items.size()),
                fmt::format("{}, one a column (~ where nothing is published)", count));
        continue;
      }
      for (std::size_t i = 0; i < count; ++i) {
        if (row.items[i]->is_null()) continue;
        PublishedColumn& column = out_.columns[first + i];
        const auto value = number(*row.items[i], fmt::format("'{}' of row '{}'", column.name, entry.key));
        if (value) column.values[entry.key] = {*value, row.items[i]->text};
      }
    }
  }
  void check_row(const YamlEntry& row, const std::string& what, std::size_t first) {
    if (first == out_.columns.size() || out_.columns[first].rows != PublishedRows::scene) return;
    std::vector<std::string> names;
    for (const PublishedScene& scene : out_.scenes) names.push_back(scene.name);
    if (std::find(names.begin(), names.end(), row.key) != names.end()) return;
    problem(row.where, fmt::format("row '{}' of {} is no scene of this file", row.key, what),
            fmt::format("one of {}", fmt::join(names, ", ")), nearest_name(row.key, names));
  }

  Published& out_;
  std::vector<Diagnostic> problems_;
};

}  // namespace

bool Tolerance::accepts(double published, double ours) const {
  return std::abs(ours - published) <= (relative ? amount * std::abs(published) : amount);
}

std::string Tolerance::text(std::string_view unit) const {
  if (relative) return fmt::format("{:g} % of the published value", amount * 100);
  if (unit == "%") return fmt::format("{:g} {}", amount, amount == 1 ? "point" : "points");
  return unit.empty() ? fmt::format("{:g}", amount) : fmt::format("{:g} {}", amount, unit);
}

const PublishedColumn* Published::find(std::string_view key) const {
  const auto found = std::find_if(columns.begin(), columns.end(), [&](const PublishedColumn& c) { return c.key() == key; });
  return found == columns.end() ? nullptr : &*found;
}

const PublishedColumn& Published::column(std::string_view key, const SourceLocation& where) const {
  if (const PublishedColumn* found = find(key)) return *found;
  std::vector<std::string> keys;
  for (const PublishedColumn& c : columns) keys.push_back(c.key());
  throw Error(Diagnostic{where, fmt::format("there is no published value '{}' in {}", key, file),
                         fmt::format("one of {}", fmt::join(keys, ", ")), nearest_name(key, keys)});
}

const PublishedScene* Published::scene_of(std::string_view ours) const {
  const auto found =
      std::find_if(scenes.begin(), scenes.end(), [&](const PublishedScene& s) { return s.ours == ours && !ours.empty(); });
  return found == scenes.end() ? nullptr : &*found;
}

Published parse_published(const std::string& text, const std::string& file) {
  Published published;
  published.file = file;
  std::vector<Diagnostic> problems;
  const auto root = parse_yaml(text, file, problems);
  Reader reader(published, std::move(problems));
  reader.read(*root);
  reader.finish();
  return published;
}

Published read_published(const std::filesystem::path& file) {
  Published published;
  published.file = file.string();
  std::vector<Diagnostic> problems;
  const auto root = read_yaml(published.file, problems);
  Reader reader(published, std::move(problems));
  reader.read(*root);
  reader.finish();
  return published;
}

}  // namespace raystudy
