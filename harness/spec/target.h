#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace raystudy {

/// What a value is to reach: a bound, and on which side of it.
struct Target {
  bool is_least = true;    ///< the bound is the least value that will do; else the greatest
  bool is_strict = false;  ///< the bound itself will not do
  double bound = 0;        ///< in the unit shown
  std::string bound_text;  ///< as written

  [[nodiscard]] bool is_met_by(double value) const;
  /// "≥ 1.15".
  [[nodiscard]] std::string text() const;
};

/// Reads ">= 1.15", "<= 1", "> 1", "< 1"; nothing where it is none of these.
[[nodiscard]] std::optional<Target> parse_target(std::string_view text);

}  // namespace raystudy
