#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "harness/spec/plan.h"

namespace raystudy {

/// The whole matrix, scene by scene: for each method its build cell, then one cell for each of its tracers and each workload.
[[nodiscard]] std::vector<Cell> expand_cells(const Plan& plan);

/// `scene/method` of a build cell, `scene/method/tracer/workload` of a traced one, in labels.
[[nodiscard]] std::string cell_path(const Plan& plan, const Cell& cell);

/// True where `glob` names the path: `*` stands for any letters within a part, `?` for one; parts left out at the end stand for
/// all. `sibenik*` is every cell of those scenes, `*/insertion` the builds and rays of one method. Brackets mean themselves.
[[nodiscard]] bool path_matches(std::string_view glob, std::string_view path);

/// Which part of the matrix one of `count` machines runs: scenes i, i + count, … A scene's cells stay together, so that the
/// methods compared with each other are timed side by side.
struct Shard {
  int index = 1;  ///< from 1
  int count = 1;
};
/// Reads "i/n". Throws Error.
[[nodiscard]] Shard read_shard(std::string_view text);

/// Keeps the cells of `plan` that `only` (empty: all) names and that fall to `shard`. Throws Error where `only` names no cell at
/// all.
void select_cells(Plan& plan, std::string_view only, Shard shard);

}  // namespace raystudy
