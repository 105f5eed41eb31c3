#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/error.h"
#include "harness/run/result.h"

namespace raystudy {

/// How near our scene is to the paper's. same: the same model. close_variant: another export or edition of it, a few per cent of
/// the triangles apart; compared like the same model, and every verdict says so. variant: remodelled or of another size; exact
/// and absolute values are not comparable, of relative ones only the direction is. unverified: a user may
/// add the file, but none has been held against the paper yet; judged like a variant.
enum class Comparability : unsigned char { same, close_variant, variant, unverified };

/// What a published number can be held to. value: the number itself, within its tolerance. trend: its direction. nothing: it is
/// shown only (times on other hardware).
enum class ComparedBy : unsigned char { value, trend, nothing };

/// What the published rows are about. A claim ("by 17 % on average") belongs to no row of ours.
enum class PublishedRows : unsigned char { scene, method, claim };

/// How far a matching value may lie from the published one.
struct Tolerance {
  bool relative = true;  ///< `amount` is a share of the published value; else it is in the column's unit
  double amount = 0;
  [[nodiscard]] bool accepts(double published, double ours) const;
  /// "1 % of the published value", "0.5 points", "0.5 s".
  [[nodiscard]] std::string text(std::string_view unit) const;
};

/// A number as printed in the paper.
struct PublishedValue {
  double value = 0;
  std::string text;  ///< with the paper's own decimals
};

struct PublishedScene {
  std::string name;  ///< the paper's
  std::string ours;  ///< catalog or generator name; empty where the catalog has none
  Comparability comparability = Comparability::same;
  std::string reason;  ///< what differs; empty only for the same model
};

struct PublishedColumn {
  std::string table;  ///< key of the table
  std::string name;   ///< key within the table
  std::string what;   ///< in words
  std::string unit;   ///< "%", "s", …; empty for a pure number
  ValueClass value_class = ValueClass::exact;
  ComparedBy compared_by = ComparedBy::value;
  std::string reason;  ///< why it is not compared by value; empty where it is
  Tolerance tolerance;
  std::optional<double> baseline;  ///< the value that means "no change" in a relative column, e.g. 100 for a cost in % of another
  std::string source;              ///< place in the paper: "Table 1, p. 17"
  PublishedRows rows = PublishedRows::scene;
  std::map<std::string, PublishedValue> values;  ///< by the paper's row name
  [[nodiscard]] std::string key() const { return table + '.' + name; }
};

/// A paper's numbers, typed in: results/published/<paper>.yaml.
struct Published {
  std::string file;
  std::string citation;
  std::vector<PublishedScene> scenes;    ///< in the paper's order
  std::vector<PublishedColumn> columns;  ///< in the file's order

  /// Null where there is none.
  [[nodiscard]] const PublishedColumn* find(std::string_view key) const;
  /// Throws Error at `where` with the nearest key.
  [[nodiscard]] const PublishedColumn& column(std::string_view key, const SourceLocation& where) const;
  /// The paper's scene that ours, by catalog name, stands for; null where there is none.
  [[nodiscard]] const PublishedScene* scene_of(std::string_view ours) const;
};

/// Reads and checks a file of published values. Throws one Error with all of its diagnostics, each with line and column.
[[nodiscard]] Published read_published(const std::filesystem::path& file);
/// The same for text already read; `file` is the name that diagnostics show.
[[nodiscard]] Published parse_published(const std::string& text, const std::string& file);

}  // namespace raystudy
