#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/yaml.h"
#include "harness/method/params.h"
#include "harness/spec/plan.h"

namespace raystudy {

/// What reading one file at one scale carries along: the scale, and everything found wrong so far.
struct Reading {
  Scale scale = Scale::quick;
  std::vector<Diagnostic> problems;
  /// Names that the file gives, by kind of thing ("method", "scene"), right or wrong: what is wrong itself is not missed
  /// elsewhere.
  std::map<std::string, std::set<std::string>, std::less<>> declared{};

  void report(const SourceLocation& where, std::string message, std::string expected = {}, std::string nearest = {});
  /// `found` is not one of `known`: names the nearest.
  void report_unknown(const SourceLocation& where, std::string message, std::string_view found,
                      const std::vector<std::string>& known);
  /// The node itself, or what a map over quick, full and paper says for the scale: the largest entry that is not above it.
  [[nodiscard]] const YamlNode& at_scale(const YamlNode& node);
};

/// Reads a map key by key, then reports the keys that nobody asked for.
class Fields {
 public:
  /// `owner` names the map in messages, e.g. "the experiment", "method 'sah'". Reports a node that is no map.
  Fields(Reading& reading, const YamlNode& node, std::string owner);

  [[nodiscard]] bool is_map() const { return node_->is_map(); }
  [[nodiscard]] const SourceLocation& where() const { return node_->where; }
  /// The value at the reading's scale, or null.
  [[nodiscard]] const YamlNode* find(std::string_view key);
  /// The same; reports its absence.
  [[nodiscard]] const YamlNode* require(std::string_view key, std::string_view what);
  /// A text (any scalar), or `fallback`.
  [[nodiscard]] std::string text(std::string_view key, std::string fallback = {});
  /// Texts: a list of them, or a single one.
  [[nodiscard]] std::vector<YamlEntry> names(std::string_view key);
  /// A number, truth value or choice as `spec` takes it, under `spec.name`; its default where absent or wrong.
  [[nodiscard]] ParamValue value(const ParamSpec& spec);
  /// A number with a unit, e.g. "0.5 s" or "4 GiB", in the base unit (seconds, bytes); `fallback` where absent or wrong.
  [[nodiscard]] double quantity(std::string_view key, double fallback, const std::vector<std::pair<std::string, double>>& units,
                                std::string_view example);
  void finish();

 private:
  Reading& reading_;
  const YamlNode* node_;
  std::string owner_;
  std::vector<std::string> asked_;
};

/// The texts of a node that is a list of scalars or one scalar, each with its place; reports anything else. `what` names the
/// node, e.g. "'tracers'".
[[nodiscard]] std::vector<YamlEntry> read_names(Reading& reading, const YamlNode& node, const std::string& what);

/// The whole text as a number; nothing where it is none.
[[nodiscard]] std::optional<double> parse_real(std::string_view text);
/// `threads`, of an experiment or a method.
[[nodiscard]] ParamSpec threads_param(int fallback);
/// Units of times for Fields::quantity, in seconds.
[[nodiscard]] const std::vector<std::pair<std::string, double>>& time_units();

/// Reads a scalar as `spec` takes it (of a method: its name only). Reports, under `what`, and returns nothing where it does not
/// fit.
[[nodiscard]] std::optional<ParamValue> read_scalar(Reading& reading, const YamlNode& node, const ParamSpec& spec,
                                                    const std::string& what);

/// Reports a label that paths of cells, files or the command line could not hold: an empty one, or one with any of / [ ] , or
/// control letters.
void check_label(Reading& reading, const SourceLocation& where, const std::string& label);

/// A value as it stands in labels: the shortest text that reads back; a method's name; a file's, without its folder.
[[nodiscard]] std::string label_text(const ParamValue& value);

/// Things of a plan by label.
template <class T>
[[nodiscard]] std::optional<std::size_t> index_of(const std::vector<T>& things, std::string_view label) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].label == label) return i;
  }
  return std::nullopt;
}
template <class T>
[[nodiscard]] std::vector<std::string> labels_of(const std::vector<T>& things) {
  std::vector<std::string> labels;
  labels.reserve(things.size());
  for (const T& thing : things) labels.push_back(thing.label);
  return labels;
}

}  // namespace raystudy
