// Whatever a file holds, reading it ends in a plan or in an Error that has a place: never in a crash or another exception.
#include <gtest/gtest.h>

#include <random>

#include "harness/spec/plan.h"

namespace raystudy {
namespace {

const std::string study = R"(
title: "All of it"
paper: insertion-bittner
cost: {c_T: 3, c_I: 2, heuristic: surface-area}
seed: 1
repetitions: {quick: 3, full: 5, paper: 10}
warm_up: 0.1 s
memory_limit: 4 GiB
scenes:
  - sibenik-ogre
  - terrain: {triangles: [1000, 2000], seed: 3, label: hills}
methods:
  tree: &tree {builder: {test-builder: {bins: [4, 8], centres: box, heuristic: {surface-area: }}}}
  wide: {from: tree, encode: test-encoder, tracers: [w]}
  again: *tree
  more: {from: again, optimize: [test-optimizer: {percent: 0.5}, test-optimizer]}
tracers: {t: test-tracer, w: test-wide-tracer}
workloads: [test-rays: {count: 1e3}]
metrics: [test-metric]
tables:
  one:
    caption: 'Costs'
    rows: method
    only: [tree, wide]
    scene: sibenik-ogre
    columns:
      cost: {metric: test_cost, relative_to: "wide[bins=4]", unit: "%", decimals: 1}
      rate: {metric: trace_rate, tracer: t, workload: test-rays, unit: Mrays/s}
      both: {formula: (cost + 2) / rate}
figures:
  depths: {kind: depth-histogram, styles: {tree: red dashed, wide: "#00ff00"}}
  lines: {kind: line, y: test_curve, log_x: true}
)";

TEST(Mutations, NeverEndInAnythingButAPlanOrAnError) {
  ASSERT_NO_THROW((void)parse_plan(study, "x.yaml", Scale::quick));
  std::mt19937 random(20240611);
  const auto below = [&random](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  static constexpr char spices[] = "{}[]:,-&*!|>'\"%@`#?\n \t\0\xff\xc3~.0eE9";
  constexpr std::string_view spice(spices, sizeof(spices) - 1);  // past its NUL
  int plans = 0;
  int errors = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string text = study;
    for (std::size_t change = 0; change <= below(6); ++change) {
      const std::size_t at = below(text.size());
      switch (below(5)) {
        case 0: text[at] = spice[below(spice.size())]; break;
        case 1: text.erase(at, 1 + below(20)); break;
        case 2: text.insert(at, 1, spice[below(spice.size())]); break;
        case 3: text.insert(at, study.substr(below(study.size()), 1 + below(40))); break;
        default: text[at] = static_cast<char>(below(256)); break;
      }
      if (text.empty()) text = " ";
    }
    try {
      (void)parse_plan(text, "x.yaml", static_cast<Scale>(below(3)));
      ++plans;
    } catch (const Error& error) {
      ++errors;
      for (const Diagnostic& problem : error.diagnostics()) {
        EXPECT_EQ(problem.where.file, "x.yaml") << problem.text() << "\n" << text;
      }
    }
  }
  EXPECT_GT(plans, 0);
  EXPECT_GT(errors, 0);
}

TEST(Mutations, EveryBeginningOfAFileIsRead) {
  for (std::size_t size = 0; size < study.size(); size += 7) {
    try {
      (void)parse_plan(study.substr(0, size), "x.yaml", Scale::quick);
    } catch (const Error& error) {
      EXPECT_FALSE(error.diagnostics().empty());
    }
  }
}

}  // namespace
}  // namespace raystudy
