#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "harness/method/params.h"

namespace raystudy {

/// A kind of figure that YAML may ask for: what it shows, whether it needs rays, and its options.
struct FigureKind {
  std::string name;
  std::string summary;
  bool traced = false;            ///< takes workloads and a tracer
  bool drawn_per_method = false;  ///< takes methods; else the picture does not depend on them
  bool styled = false;            ///< takes a style for each method
  bool takes_own_tracers =
      false;  ///< shows each method with its own tracer where YAML names none, by default all that are traced
  std::vector<ParamSpec> options;  ///< FigureSpec::options holds each as text
};

[[nodiscard]] const std::vector<FigureKind>& figure_kinds();
[[nodiscard]] const FigureKind* find_figure_kind(std::string_view name);

}  // namespace raystudy
