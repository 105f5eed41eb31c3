#include "harness/spec/target.h"

#include <cmath>

#include "harness/spec/reading.h"

namespace raystudy {

bool Target::is_met_by(double value) const {
  if (value == bound) return !is_strict;
  return is_least ? value > bound : value < bound;
}

std::string Target::text() const {
  const std::string_view relation = is_least ? (is_strict ? "> " : "≥ ") : (is_strict ? "< " : "≤ ");
  return std::string(relation) + bound_text;
}

std::optional<Target> parse_target(std::string_view text) {
  if (text.empty() || (text.front() != '>' && text.front() != '<')) return std::nullopt;
  Target target;
  target.is_least = text.front() == '>';
  text.remove_prefix(1);
  target.is_strict = !text.starts_with('=');
  if (!target.is_strict) text.remove_prefix(1);
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  const std::optional<double> bound = parse_real(text);
  if (!bound || !std::isfinite(*bound)) return std::nullopt;
  target.bound = *bound;
  target.bound_text = text;
  return target;
}

}  // namespace raystudy
