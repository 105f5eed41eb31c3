#pragma once

#include <string>
#include <vector>

#include "harness/report/table.h"
#include "harness/spec/plan.h"

namespace raystudy {

/// A study of the shape of the lecture's Table 1 for tests: scenes sibenik-ogre, conference and a failed one; methods sah and
/// insertion.
inline Plan test_plan() {
  Plan plan;
  plan.file = RAYSTUDY_SOURCE_DIR "/experiments/test.yaml";
  plan.name = "test";
  plan.title = "A test";
  plan.paper = "insertion-bittner";
  plan.cost.heuristic.name = "surface-area";
  for (const char* name : {"sibenik-ogre", "sponza-dabrovic", "conference", "atrium"}) {
    SceneSpec scene;
    scene.label = name;
    scene.base = name;
    scene.name = name;
    plan.scenes.push_back(scene);
  }
  for (const char* method : {"sah", "insertion"}) {
    PipelineSpec pipeline;
    pipeline.label = method;
    pipeline.base = method;
    plan.pipelines.push_back(pipeline);
  }
  TableSpec table;
  table.name = "table1";
  table.caption = "Costs & times, 100 % of them";
  table.rows = "scene";
  const auto column = [&](const char* name, const char* label, const char* metric, const char* method, const char* base,
                          const char* published, int decimals) {
    ColumnSpec c;
    c.name = name;
    c.label = label;
    c.metric = metric;
    c.methods = {method};
    if (*base != '\0') c.relative_to = {base};
    c.published = published;
    c.decimals = decimals;
    c.unit = std::string(base).empty() && std::string(metric) == "total_time" ? "s" : "";
    c.where = {"test.yaml", 10 + static_cast<int>(table.columns.size()), 7};
    table.columns.push_back(c);
  };
  column("cost", "cost SAH", "cost", "sah", "", "table1.cost", 2);
  column("relative_cost", "rel. cost optimized", "cost", "insertion", "sah", "table1.relative_cost", 2);
  column("time", "time SAH", "total_time", "sah", "", "table1.time", 3);
  column("relative_time", "rel. time optimized", "total_time", "insertion", "sah", "table1.relative_time", 1);
  plan.tables.push_back(table);
  return plan;
}

inline CellResult test_result(const std::string& scene, const std::string& method, double cost, std::vector<double> seconds) {
  CellResult r;
  r.id = scene + method;
  r.experiment = "test";
  r.scene = scene;
  r.method = method;
  r.values["cost"] = {ValueClass::exact, "1", {cost}};
  r.values["total_time"] = {ValueClass::absolute, "s", std::move(seconds)};
  r.provenance = {{"cpu", "A fast one"}, {"threads", "1"}, {"commit", "abc"}, {"timing_group", "1"}};
  return r;
}

/// sibenik-ogre and conference measured, sponza-dabrovic not run, atrium failed while it was optimized.
inline std::vector<CellResult> test_results() {
  std::vector<CellResult> results{
      test_result("sibenik-ogre", "sah", 82.21, {0.05, 0.052, 0.06}),
      test_result("sibenik-ogre", "insertion", 69.8, {0.4, 0.41, 0.45}), test_result("conference", "sah", 140.5, {0.2, 0.2, 0.2}),
      test_result("conference", "insertion", 110.25, {1.5, 1.5, 1.5}), test_result("atrium", "sah", 50.125, {0.1, 0.1, 0.1})};
  CellResult failed = test_result("atrium", "insertion", 0, {});
  failed.status = CellStatus::failed;
  failed.reason = "timed out after 60 s";
  failed.values.clear();
  results.push_back(failed);
  return results;
}

}  // namespace raystudy
