#pragma once

#include "harness/report/table.h"
#include "harness/report/value.h"

namespace raystudy {

/// The scenes of the plan that are points of the sweep `base` (SceneSpec::base), in order.
[[nodiscard]] std::vector<const SceneSpec*> scenes_of(const Plan& plan, const std::string& base);
/// The bases of the scenes that `labels` names, or of all where it is empty; each once, in order.
[[nodiscard]] std::vector<std::string> scene_bases(const Plan& plan, const std::vector<std::string>& labels);

/// The power of the triangles with which the column's value grows over the scenes of the base `place.scene`, fitted to medians,
/// with one standard error to each side. Scenes without a value are named in the reason.
[[nodiscard]] ReportCell slope_cell(const ColumnSpec& column, const ValuePlace& place, const Plan& plan,
                                    const ResultSet& results);

}  // namespace raystudy
