#include "harness/report/published.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

namespace raystudy {
namespace {

template <class T>
using Choices = std::vector<std::pair<std::string, T>>;

const Choices<Comparability> comparabilities{{"same", Comparability::same},
                                             {"close-variant", Comparability::close_variant},
                                             {"variant", Comparability::variant},
                                             {"absent", Comparability::absent}};
const Choices<ComparedBy> comparisons{
    {"value", ComparedBy::value}, {"trend", ComparedBy::trend}, {"nothing", ComparedBy::nothing}};
const Choices<PublishedRows> row_kinds{
    {"scene", PublishedRows::scene}, {"method", PublishedRows::method}, {"claim", PublishedRows::claim}};
const Choices<ValueClass> classes{{"exact", ValueClass::exact}, {"ratio", ValueClass::ratio}, {"absolute", ValueClass::absolute}};

/// The entries of a mapping in the order written.
class Keys {
 public:
  bool add(std::string key, const YAML::Node& value) {
    if (find(key) != end()) return false;
    entries_.emplace_back(std::move(key), value);
    return true;
  }
  using Entries = std::vector<std::pair<std::string, YAML::Node>>;
  [[nodiscard]] Entries::const_iterator begin() const { return entries_.begin(); }
  [[nodiscard]] Entries::const_iterator end() const { return entries_.end(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] bool contains(const std::string& key) const { return find(key) != end(); }
  [[nodiscard]] Entries::const_iterator find(const std::string& key) const {
    return std::find_if(begin(), end(), [&](const auto& entry) { return entry.first == key; });
  }

 private:
  Entries entries_;
};

/// Walks the YAML tree and keeps every diagnostic.
class Reader {
 public:
  Reader(std::string file, Published& out) : file_(std::move(file)), out_(out) {}

  void read(const YAML::Node& root) {
    const auto keys = mapping(root, "the file", {"citation", "scenes", "tables"});
    out_.citation = text(keys, "citation");
    if (const auto scenes = keys.find("scenes"); scenes != keys.end()) read_scenes(scenes->second);
    if (const auto tables = keys.find("tables"); tables != keys.end()) read_tables(tables->second);
    missing(root, keys, {"citation", "scenes", "tables"}, "the file");
  }
  void finish() {
    std::stable_sort(problems_.begin(), problems_.end(), [](const Diagnostic& a, const Diagnostic& b) {
      return std::pair(a.where.line, a.where.column) < std::pair(b.where.line, b.where.column);
    });
    if (!problems_.empty()) throw Error(problems_);
  }

 private:
  [[nodiscard]] SourceLocation at(const YAML::Node& node) const {
    const YAML::Mark mark = node.Mark();
    return {file_, mark.line + 1, mark.column + 1};
  }
  void problem(const YAML::Node& node, std::string message, std::string expected = {}, std::string nearest = {}) {
    problems_.push_back({at(node), std::move(message), std::move(expected), std::move(nearest)});
  }

  Keys mapping(const YAML::Node& node, const std::string& what, const std::vector<std::string>& allowed) {
    Keys found;
    if (!node.IsMap()) {
      problem(node, fmt::format("{} is not a mapping", what), fmt::format("the keys {}", fmt::join(allowed, ", ")));
      return found;
    }
    for (const auto& entry : node) {
      const auto key = entry.first.as<std::string>("");
      if (!allowed.empty() && std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
        problem(entry.first, fmt::format("unknown key '{}' in {}", key, what), fmt::format("one of {}", fmt::join(allowed, ", ")),
                nearest_name(key, allowed));
      } else if (!found.add(key, entry.second)) {
        problem(entry.first, fmt::format("duplicate key '{}' in {}", key, what));
      }
    }
    return found;
  }
  void missing(const YAML::Node& node, const Keys& keys, const std::vector<std::string>& needed, const std::string& what) {
    if (!node.IsMap()) return;
    for (const std::string& key : needed) {
      if (!keys.contains(key)) problem(node, fmt::format("{} has no '{}'", what, key));
    }
  }
  std::string text(const Keys& keys, const std::string& key) {
    const auto found = keys.find(key);
    if (found == keys.end()) return {};
    if (!found->second.IsScalar()) {
      problem(found->second, fmt::format("'{}' is not text", key));
      return {};
    }
    return found->second.Scalar();
  }
  template <class T>
  T choice(const Keys& keys, const std::string& key, const Choices<T>& choices) {
    const auto found = keys.find(key);
    if (found == keys.end()) return choices.front().second;
    const std::string value = found->second.IsScalar() ? found->second.Scalar() : "";
    std::vector<std::string> names;
    for (const auto& [name, meaning] : choices) {
      if (name == value) return meaning;
      names.push_back(name);
    }
    problem(found->second, fmt::format("'{}' is '{}'", key, value), fmt::format("one of {}", fmt::join(names, ", ")),
            nearest_name(value, names));
    return choices.front().second;
  }
  std::optional<double> number(const YAML::Node& node, const std::string& what) {
    double value = 0;
    if (node.IsScalar() && YAML::convert<double>::decode(node, value) && std::isfinite(value)) return value;
    problem(node, fmt::format("{} is '{}'", what, node.IsScalar() ? node.Scalar() : "no number"), "a number");
    return {};
  }

  void read_scenes(const YAML::Node& node) {
    for (const auto& [name, entry] : mapping(node, "'scenes'", {})) {
      const std::string what = fmt::format("scene '{}'", name);
      const Keys keys = mapping(entry, what, {"ours", "comparability", "reason"});
      PublishedScene scene{name, text(keys, "ours"), choice(keys, "comparability", comparabilities), text(keys, "reason")};
      if (scene.comparability != Comparability::absent && entry.IsMap()) missing(entry, keys, {"ours"}, what);
      if (scene.comparability != Comparability::same) missing(entry, keys, {"reason"}, what);
      if (!scene.ours.empty() && out_.scene_of(scene.ours) != nullptr) {
        problem(entry, fmt::format("scenes '{}' and '{}' are both our '{}'", out_.scene_of(scene.ours)->name, name, scene.ours));
      }
      out_.scenes.push_back(std::move(scene));
    }
  }

  void read_tables(const YAML::Node& node) {
    for (const auto& [name, entry] : mapping(node, "'tables'", {})) {
      const std::string what = fmt::format("table '{}'", name);
      const Keys keys = mapping(entry, what, {"source", "rows", "columns", "values"});
      missing(entry, keys, {"source", "columns", "values"}, what);
      const std::size_t first = out_.columns.size();
      const auto columns = keys.find("columns");
      if (columns == keys.end()) continue;
      if (!columns->second.IsSequence()) {
        problem(columns->second, fmt::format("'columns' of {} is not a list", what));
        continue;
      }
      for (const YAML::Node& column : columns->second) {
        PublishedColumn read = read_column(column, name);
        read.rows = choice(keys, "rows", row_kinds);
        if (read.source.empty()) read.source = text(keys, "source");
        if (out_.find(read.key()) != nullptr) problem(column, fmt::format("duplicate column '{}' in {}", read.name, what));
        out_.columns.push_back(std::move(read));
      }
      if (const auto values = keys.find("values"); values != keys.end()) read_values(values->second, what, first);
    }
  }

  PublishedColumn read_column(const YAML::Node& node, const std::string& table) {
    const std::string what = fmt::format("a column of table '{}'", table);
    const Keys keys = mapping(node, what, {"name", "what", "unit", "class", "compare", "reason", "tolerance", "source"});
    missing(node, keys, {"name", "what", "unit", "class"}, what);
    PublishedColumn column;
    column.table = table;
    column.name = text(keys, "name");
    column.what = text(keys, "what");
    column.unit = text(keys, "unit");
    column.source = text(keys, "source");
    column.reason = text(keys, "reason");
    column.value_class = choice(keys, "class", classes);
    column.compared_by = choice(keys, "compare", comparisons);
    if (column.compared_by == ComparedBy::value) {
      missing(node, keys, {"tolerance"}, fmt::format("column '{}', which is compared by value,", column.name));
      if (const auto tolerance = keys.find("tolerance"); tolerance != keys.end())
        column.tolerance = read_tolerance(tolerance->second);
      if (column.value_class == ValueClass::absolute) {
        problem(node, fmt::format("column '{}' is absolute and compared by value", column.name),
                "'compare: trend' or 'compare: nothing': an absolute number belongs to its machine");
      }
    } else {
      missing(node, keys, {"reason"}, fmt::format("column '{}', which is not compared by value,", column.name));
    }
    return column;
  }

  Tolerance read_tolerance(const YAML::Node& node) {
    const Keys keys = mapping(node, "'tolerance'", {"relative", "absolute"});
    Tolerance tolerance;
    if (keys.size() != 1) {
      if (node.IsMap()) problem(node, "'tolerance' needs exactly one of 'relative' and 'absolute'");
      return tolerance;
    }
    const auto& [key, value] = *keys.begin();
    tolerance.relative = key == "relative";
    tolerance.amount = number(value, fmt::format("'{}'", key)).value_or(0);
    if (tolerance.amount < 0) problem(value, fmt::format("'{}' is {}", key, tolerance.amount), "a number of at least 0");
    return tolerance;
  }

  void read_values(const YAML::Node& node, const std::string& what, std::size_t first) {
    const std::size_t count = out_.columns.size() - first;
    for (const auto& [row, numbers] : mapping(node, fmt::format("'values' of {}", what), {})) {
      check_row(node, row, what, first);
      if (!numbers.IsSequence() || numbers.size() != count) {
        problem(numbers, fmt::format("row '{}' of {} has {} values", row, what, numbers.IsSequence() ? numbers.size() : 0),
                fmt::format("{}, one a column (~ where nothing is published)", count));
        continue;
      }
      for (std::size_t i = 0; i < count; ++i) {
        if (numbers[i].IsNull()) continue;
        const auto value = number(numbers[i], fmt::format("'{}' of row '{}'", out_.columns[first + i].name, row));
        if (value) out_.columns[first + i].values[row] = {*value, numbers[i].Scalar()};
      }
    }
  }
  void check_row(const YAML::Node& values, const std::string& row, const std::string& what, std::size_t first) {
    if (first == out_.columns.size() || out_.columns[first].rows != PublishedRows::scene) return;
    std::vector<std::string> names;
    for (const PublishedScene& scene : out_.scenes) names.push_back(scene.name);
    if (std::find(names.begin(), names.end(), row) != names.end()) return;
    for (const auto& entry : values) {
      if (entry.first.as<std::string>("") != row) continue;
      problem(entry.first, fmt::format("row '{}' of {} is no scene of this file", row, what),
              fmt::format("one of {}", fmt::join(names, ", ")), nearest_name(row, names));
    }
  }

  std::string file_;
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
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Error(
        Diagnostic{{file, error.mark.line + 1, error.mark.column + 1}, fmt::format("this is not YAML: {}", error.msg), {}, {}});
  }
  Reader reader(file, published);
  reader.read(root);
  reader.finish();
  return published;
}

Published read_published(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream) throw Error(Diagnostic{{file.string(), 0, 0}, "cannot read the published values", {}, {}});
  return parse_published(text.str(), file.string());
}

}  // namespace raystudy
