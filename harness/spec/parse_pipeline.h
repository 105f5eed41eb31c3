#pragma once

#include <string>
#include <vector>

#include "harness/spec/plan.h"

namespace raystudy {

/// A pipeline put together outside an experiment, e.g. by flags: a method a text, as an experiment writes it, `NAME` or
/// `NAME: {parameter: value}`. Its label joins the names.
struct PipelineText {
  std::string builder;
  std::vector<std::string> optimizers{};
  std::string encoder{};  ///< empty: none
};

/// Throws one Error with everything that is wrong; `--builder`, `--optimize` and `--encode` stand for the file. A list of values,
/// which would be a sweep, is a mistake too.
[[nodiscard]] PipelineSpec parse_pipeline(const PipelineText& text);

}  // namespace raystudy
