#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "harness/spec/quantity.h"
#include "harness/spec/reading.h"

namespace raystudy {

/// Finds what tables and figures refer to, and reports what is not there.
class Lookup {
 public:
  Lookup(Reading& reading, const Plan& plan);

  /// The labels that `name` stands for: itself, or every sweep point of it. `what` is the kind of thing, e.g. "method".
  template <class T>
  [[nodiscard]] std::vector<std::string> all_of(const std::vector<T>& things, const YamlEntry& name,
                                                std::string_view what) const {
    std::vector<std::string> labels;
    for (const T& thing : things) {
      if (thing.label == name.key || thing.base == name.key) labels.push_back(thing.label);
    }
    if (labels.empty() && !is_reported(name.key, what)) {
      reading_.report_unknown(name.where, fmt::format("there is no {} '{}' in this experiment", what, name.key), name.key,
                              labels_of(things));
    }
    return labels;
  }
  /// The one label that the node's text stands for.
  template <class T>
  [[nodiscard]] std::optional<std::string> one_of(const std::vector<T>& things, const YamlNode& node,
                                                  std::string_view what) const {
    if (!node.is_scalar()) {
      reading_.report(node.where, fmt::format("'{}' is {}", what, described(node)), fmt::format("the name of a {}", what));
      return std::nullopt;
    }
    const std::vector<std::string> labels = all_of(things, {node.text, node.where, nullptr}, what);
    if (labels.size() > 1) {
      reading_.report(node.where, fmt::format("{} '{}' is a sweep", what, node.text),
                      fmt::format("one of {}", fmt::join(labels, ", ")));
    }
    return labels.size() == 1 ? std::optional(labels.front()) : std::nullopt;
  }
  /// The experiment's only one, for an owner that names none.
  template <class T>
  [[nodiscard]] std::optional<std::string> the_only(const std::vector<T>& things, const SourceLocation& where,
                                                    const std::string& owner, std::string_view what) const {
    if (things.size() == 1) return things.front().label;
    if (!things.empty() || reading_.declared[std::string(what)].empty()) {
      reading_.report(where, fmt::format("{} names no {}", owner, what),
                      things.empty() ? fmt::format("a {} in the experiment", what)
                                     : fmt::format("'{}', one of {}", what, fmt::join(labels_of(things), ", ")));
    }
    return std::nullopt;
  }

  /// A tracer's label, or own_tracer.
  [[nodiscard]] std::optional<std::string> tracer(const YamlNode& node) const;
  /// Reports a method that `tracer` does not trace (own_tracer: that has not just one). `owner` begins the message: "column 'x'
  /// asks for". Labels that are none have been reported.
  void check_traced(const std::string& tracer, const std::string& method, const SourceLocation& where,
                    const std::string& owner) const;

  /// A quantity that the harness or one of the experiment's metrics gives.
  [[nodiscard]] std::optional<Quantity> quantity(const std::string& name, const SourceLocation& where) const;

 private:
  /// True for a thing that the file gives and that is not in the plan since it is wrong, which is said where it stands.
  [[nodiscard]] bool is_reported(std::string_view name, std::string_view what) const;

  Reading& reading_;
  const Plan& plan_;
  std::vector<Quantity> quantities_;
};

}  // namespace raystudy
