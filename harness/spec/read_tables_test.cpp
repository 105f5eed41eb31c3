#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/method/registry.h"
#include "harness/spec/plan.h"
#include "harness/spec/quantity.h"

namespace raystudy {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Eight lines; what is tested begins on line 9.
const std::string study = R"(scenes: [sibenik-ogre, conference]
methods:
  tree: test-builder
  wide: {from: tree, encode: test-encoder}
  many: {from: tree, optimize: [test-optimizer: {bins: [1, 2]}]}
tracers: {t: test-tracer, w: test-wide-tracer}
workloads: {few: {test-rays: {count: 10}}, lots: {test-rays: {count: 20}}}
paper: insertion-bittner
)";

Plan read(const std::string& rest) { return parse_plan(study + rest, "x.yaml", Scale::quick); }

/// What is wrong with the study and `rest`, after each first text of `changes` has become the second.
std::string errors(const std::string& rest, const std::vector<std::pair<std::string, std::string>>& changes = {}) {
  std::string text = study + rest;
  for (const auto& [from, to] : changes) text.replace(text.find(from), from.size(), to);
  try {
    (void)parse_plan(text, "x.yaml", Scale::quick);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// A table on line 9 whose column `c` begins at letter 28.
std::string column(const std::string& text) { return errors("tables: {t: {columns: {c: " + text + "}}}\n"); }

TEST(ReadTables, AMethodsOwnTracer) {
  const Plan plan = read("tables: {t: {rows: method, columns: {c: {metric: trace_rate, tracer: own, workload: few}}}}\n");
  EXPECT_EQ(plan.tables[0].columns[0].tracer, own_tracer);
  EXPECT_EQ(read("tables: {t: {tracer: own, columns: {c: {metric: trace_rate, method: tree, workload: few}}}}\n")
                .tables[0]
                .columns[0]
                .tracer,
            own_tracer);
  EXPECT_THAT(errors("tables: {t: {columns: {c: {metric: trace_rate, method: untraced, tracer: own, workload: few}}}}\n",
                     {{"  many:", "  untraced: {from: tree, tracers: []}\n  many:"}}),
              "x.yaml:10:36: column 'c' asks for the own tracer of method 'untraced', which has none; expected a method that is "
              "traced");
  EXPECT_THAT(errors("tables: {t: {columns: {c: {metric: trace_rate, method: tree, tracer: own, workload: few}}}}\n",
                     {{"{t: test-tracer,", "{t: test-tracer, u: test-tracer,"}}),
              "x.yaml:9:36: column 'c' asks for the own tracer of method 'tree', which has several; expected one of t, u");
}

TEST(ReadTables, TheBestOfSeveralMethodsAndATarget) {
  const Plan plan = read(R"(
tables:
  targets:
    columns: scene
    tracer: own
    rows:
      rate: {metric: trace_rate, workload: few, best_of: [tree, many], relative_to: [wide, "many[bins=2]"], target: ">= 1.15"}
      time: {metric: total_time, best_of: many, unit: ms, target: {conference: "< 3"}}
      cost: {metric: cost_over_time, method: tree, at: {sibenik-ogre: 29 ms}}
      later: {metric: cost_over_time, method: tree, at: 2 s}
      until: {metric: cost_over_time, method: tree, until: "many[bins=1]", unit: ms}
      faster: {metric: cost_over_time, method: tree, until: "many[bins=1]", relative_to: "many[bins=1]"}
)");
  const TableSpec& table = plan.tables.at(0);
  EXPECT_EQ(table.rows, "scene");
  EXPECT_TRUE(table.transposed);
  const ColumnSpec& rate = table.columns.at(0);
  EXPECT_THAT(rate.methods, ElementsAre("tree", "many[bins=1]", "many[bins=2]"));
  EXPECT_THAT(rate.relative_to, ElementsAre("wide", "many[bins=2]"));
  EXPECT_EQ(rate.tracer, own_tracer);
  EXPECT_TRUE(rate.higher_is_better);
  EXPECT_EQ(rate.unit, "");
  ASSERT_EQ(rate.targets.size(), 2U);
  EXPECT_EQ(rate.targets.at("sibenik-ogre").text(), "≥ 1.15");
  const ColumnSpec& time = table.columns.at(1);
  EXPECT_THAT(time.methods, ElementsAre("many[bins=1]", "many[bins=2]"));
  EXPECT_FALSE(time.higher_is_better);
  ASSERT_EQ(time.targets.size(), 1U);
  EXPECT_EQ(time.targets.at("conference").text(), "< 3");
  EXPECT_EQ(table.columns.at(2).at, (std::map<std::string, double>{{"sibenik-ogre", 0.029}}));
  EXPECT_EQ(table.columns.at(3).at, (std::map<std::string, double>{{"sibenik-ogre", 2}, {"conference", 2}}));
  EXPECT_EQ(table.columns.at(4).until, "many[bins=1]");
  EXPECT_EQ(table.columns.at(4).unit, "ms");
  EXPECT_EQ(table.columns.at(5).unit, "");
}

TEST(ReadTables, TransposedTables) {
  EXPECT_TRUE(read("tables: {t: {columns: method, rows: [triangles]}}\n").tables.at(0).transposed);
  EXPECT_EQ(read("tables: {t: {columns: method, rows: [triangles]}}\n").tables.at(0).rows, "method");
  EXPECT_EQ(errors("tables: {t: {columns: methods, rows: {c: {metric: triangles, method: tree}}}}\n"),
            "x.yaml:9:23: 'columns' is the text 'methods'; expected one of scene, method; did you mean 'method'?");
  EXPECT_EQ(errors("tables: {t: {columns: method, rows: []}}\n"), "x.yaml:9:37: 'rows' is empty; expected at least one row");
  EXPECT_EQ(errors("tables: {t: {rows: {c: {metric: triangle, method: tree}}}}\n").substr(0, 62),
            "x.yaml:9:33: there is no quantity 'triangle'; expected one of ");
  EXPECT_EQ(errors("tables: {t: {columns: method, rows: {c: {metric: triangles, method: tree}}}}\n"),
            "x.yaml:9:69: 'method' stands in a table whose columns are methods; expected a row without it");
  EXPECT_EQ(errors("tables: {t: {rows: {a: {metric: triangles, method: tree}, b: {formula: c}}}}\n"),
            "x.yaml:9:72: the formula of row 'b' asks for 'c', which is no row before it; expected one of a");
}

TEST(ReadTables, MistakesInListsOfMethods) {
  EXPECT_EQ(column("{metric: triangles, best_of: []}"), "x.yaml:9:56: 'best_of' is empty; expected at least one method");
  EXPECT_EQ(column("{metric: triangles, best_of: [tree, wid]}"),
            "x.yaml:9:63: there is no method 'wid' in this experiment; expected one of tree, wide, many[bins=1], many[bins=2]; "
            "did you mean 'wide'?");
  EXPECT_EQ(column("{metric: triangles, best_of: {tree: wide}}"),
            "x.yaml:9:56: 'best_of' is a map; expected a name or a list of names");
  EXPECT_EQ(column("{metric: triangles, best_of: [[tree]]}"), "x.yaml:9:57: 'best_of' holds a list; expected a name");
  EXPECT_EQ(column("{metric: triangles, method: tree, best_of: [wide]}"),
            "x.yaml:9:70: column 'c' has both 'method' and 'best_of'; expected one of them");
  EXPECT_EQ(column("{metric: triangles, method: tree, relative_to: []}"),
            "x.yaml:9:74: 'relative_to' is empty; expected at least one method");
  EXPECT_EQ(column("{metric: triangles, method: tree, relative_to: [wide, tre]}"),
            "x.yaml:9:81: there is no method 'tre' in this experiment; expected one of tree, wide, many[bins=1], many[bins=2]; "
            "did you mean 'tree'?");
  EXPECT_EQ(column("{metric: trace_rate, best_of: [tree, wide], tracer: t, workload: few}"),
            "x.yaml:9:36: column 'c' asks for tracer 't', which does not trace method 'wide'; expected one of w");
}

TEST(ReadTables, MistakesInTargets) {
  const std::string expected = "expected a bound, such as '>= 1.15' or '< 77.3', or a map of scene to bound";
  EXPECT_EQ(column("{metric: triangles, method: tree, target: 1.15}"), "x.yaml:9:69: 'target' is the number 1.15; " + expected);
  EXPECT_EQ(column("{metric: triangles, method: tree, target: '=> 1'}"), "x.yaml:9:69: 'target' is the text '=> 1'; " + expected);
  EXPECT_EQ(column("{metric: triangles, method: tree, target: [1]}"), "x.yaml:9:69: 'target' is a list; " + expected);
  EXPECT_EQ(column("{metric: triangles, method: tree, target: {conferenc: '> 1'}}"),
            "x.yaml:9:70: there is no scene 'conferenc' in this experiment; expected one of sibenik-ogre, conference; did you "
            "mean 'conference'?");
  EXPECT_EQ(column("{metric: triangles, method: tree, target: {conference: fast}}"),
            "x.yaml:9:82: the target of 'conference' is the text 'fast'; " + expected);
  EXPECT_EQ(column("{metric: triangles, method: tree, published: table1.cost, target: '> 1'}"),
            "x.yaml:9:93: column 'c' has both 'published' and 'target'; expected one of them: a value has one verdict");
}

TEST(ReadTables, BreakEvenComparesTheMethodsOfATable) {
  const auto of = [](const std::string& rest) { return errors("tables: {t: {tracer: own, workload: few, " + rest + "}}\n"); };
  EXPECT_EQ(read("tables: {t: {rows: method, tracer: own, columns: {c: {metric: break_even, workload: few}}}}\n")
                .tables[0]
                .columns[0]
                .unit,
            "rays");
  EXPECT_EQ(of("columns: {c: {metric: break_even, method: tree}}"),
            "x.yaml:9:64: 'break_even' compares the methods of a table, and this one's rows are scenes; expected a table of "
            "methods");
  EXPECT_EQ(of("columns: method, rows: {c: {metric: break_even, relative_to: tree}}"),
            "x.yaml:9:78: row 'c' shows ranges, which are not compared; expected a row without 'relative_to', 'target' and "
            "'published'");
}

TEST(ReadTables, SlopesAreOfSweepsOfScenes) {
  const std::vector<std::pair<std::string, std::string>> sweep{
      {"[sibenik-ogre, conference]", "[terrain: {triangles: [1000, 2000, 4000]}, conference]"}};
  EXPECT_EQ(errors("tables: {t: {rows: method, slopes: true, scene: terrain, columns: [total_time]}}\n", sweep), "no error");
  EXPECT_EQ(errors("tables: {t: {rows: method, slopes: true, scene: terrian, columns: [total_time]}}\n", sweep).substr(0, 62),
            "x.yaml:9:49: there is no scene 'terrian' in this experiment; e");
  EXPECT_EQ(errors("tables: {t: {rows: method, slopes: 3, columns: [total_time]}}\n"),
            "x.yaml:9:36: 'slopes' is the integer 3; expected true or false");
  EXPECT_EQ(
      errors("tables: {t: {rows: method, slopes: true, columns: {a: total_time, b: {formula: a}}}}\n"),
      "x.yaml:9:67: column 'b' stands in a table of slopes; expected a quantity other than break_even, neither a formula nor "
      "published");
}

TEST(ReadTables, MistakesInPlacesOnASeries) {
  EXPECT_EQ(column("{metric: cost_over_time, method: tree}"),
            "x.yaml:9:36: 'cost_over_time' is a series over seconds; expected 'at' or 'until', which make one number of it; or a "
            "figure, which can draw it");
  EXPECT_EQ(column("{metric: total_time, method: tree, at: 1 s}"),
            "x.yaml:9:36: column 'c' has 'at', and 'total_time' is one number; expected a series over time, such as "
            "cost_over_time");
  EXPECT_EQ(column("{metric: cost_over_time, method: tree, at: soon}"),
            "x.yaml:9:70: 'at' is the text 'soon'; expected a number >= 0 and a unit (ms, s, min, h), such as '29 ms'");
  EXPECT_EQ(column("{metric: cost_over_time, method: tree, at: {conference: 3}}"),
            "x.yaml:9:83: 'conference' is the integer 3; expected a number >= 0 and a unit (ms, s, min, h), such as '29 ms'");
  EXPECT_EQ(column("{metric: cost_over_time, method: tree, at: 1 s, until: tree}"),
            "x.yaml:9:82: column 'c' has both 'at' and 'until'; expected one of them");
  EXPECT_EQ(column("{metric: cost_over_time, method: tree, until: [tree]}"),
            "x.yaml:9:73: 'method' is a list; expected the name of a method");
}

TEST(ReadTables, ColumnsCompletedFromTableAndPlan) {
  const Plan plan = read(R"(
tables:
  one:
    caption: Costs
    only: [conference]
    tracer: t
    workload: few
    columns:
      cost: {metric: test_cost, method: tree, label: "cost, SAH", published: table1.cost, decimals: 1}
      time: {metric: total_time, method: "many[bins=2]", relative_to: tree, unit: "%"}
      rate: {metric: trace_rate, method: tree, unit: Mrays/s}
      best: {formula: "100 * time / cost", unit: x}
  two: {rows: method, scene: conference, only: [tree, many], columns: [total_time, test_cost]}
)");
  ASSERT_EQ(plan.tables.size(), 2U);
  const TableSpec& one = plan.tables[0];
  EXPECT_EQ(one.rows, "scene");
  EXPECT_EQ(one.caption, "Costs");
  EXPECT_THAT(one.row_filter, ElementsAre("conference"));
  ASSERT_EQ(one.columns.size(), 4U);
  EXPECT_EQ(one.columns[0].label, "cost, SAH");
  EXPECT_EQ(one.columns[0].unit, "");
  EXPECT_EQ(one.columns[0].decimals, 1);
  EXPECT_EQ(one.columns[0].published, "table1.cost");
  EXPECT_EQ(one.columns[0].tracer, "");
  EXPECT_EQ(one.columns[1].methods.at(0), "many[bins=2]");
  EXPECT_THAT(one.columns[1].relative_to, ElementsAre("tree"));
  EXPECT_EQ(one.columns[1].unit, "%");
  EXPECT_EQ(one.columns[2].tracer, "t");
  EXPECT_EQ(one.columns[2].workload, "few");
  EXPECT_EQ(one.columns[3].formula, "100 * time / cost");
  EXPECT_EQ(one.columns[3].metric, "");
  const TableSpec& two = plan.tables[1];
  EXPECT_EQ(two.scene, "conference");
  EXPECT_EQ(two.caption, "two");
  EXPECT_THAT(two.row_filter, ElementsAre("tree", "many[bins=1]", "many[bins=2]"));
  EXPECT_EQ(two.columns[0].unit, "s");
  EXPECT_EQ(two.columns[0].label, "total_time");
  EXPECT_THAT(two.columns[0].methods, IsEmpty());
}

TEST(ReadTables, Mistakes) {
  EXPECT_EQ(errors("tables: [a]\n"), "x.yaml:9:9: 'tables' is a list; expected a map of name to table");
  EXPECT_EQ(errors("tables: {t: {}}\n"),
            "x.yaml:9:13: table 't' has no 'columns'; expected a map of name to column, or a list of quantities");
  EXPECT_EQ(errors("tables: {t: {columns: 3}}\n"),
            "x.yaml:9:23: 'columns' is the integer 3; expected a map of name to column, or a list of quantities");
  EXPECT_EQ(errors("tables: {t: {columns: []}}\n"), "x.yaml:9:23: 'columns' is empty; expected at least one column");
  EXPECT_EQ(errors("tables: {t: {rows: scenes, columns: {a: {metric: triangles, method: tree}}}}\n"),
            "x.yaml:9:20: 'rows' is the text 'scenes'; expected one of scene, method; did you mean 'scene'?");
  EXPECT_EQ(errors("tables: {t: {rows: method, columns: [triangles, triangles]}}\n"),
            "x.yaml:9:49: two columns are called 'triangles'; expected each name once");
  EXPECT_EQ(errors("tables: {t: {rows: method, columns: {a-b: triangles}}}\n"),
            "x.yaml:9:38: the column's name is 'a-b'; expected letters, digits and '_', as formulas can hold it");
  EXPECT_EQ(errors("tables: {t: {scene: conference, columns: {a: {metric: triangles, method: tree}}}}\n"),
            "x.yaml:9:21: 'scene' stands in a table whose rows are scenes; expected 'only' to choose among them");
  EXPECT_EQ(errors("tables: {t: {only: [sibenik], columns: {a: {metric: triangles, method: tree}}}}\n"),
            "x.yaml:9:21: there is no scene 'sibenik' in this experiment; expected one of sibenik-ogre, conference");
  EXPECT_EQ(
      errors("tables: {t: {rows: method, columns: [triangles], colum: red}}\n"),
      "x.yaml:9:50: table 't' has no key 'colum'; expected one of caption, rows, slopes, only, scene, tracer, workload, columns; "
      "did you "
      "mean 'columns'?");
}

TEST(ReadTables, MistakesInColumns) {
  EXPECT_EQ(column("[a]"), "x.yaml:9:27: column 'c' is a list; expected a map");
  EXPECT_EQ(column("{method: tree}"), "x.yaml:9:24: column 'c' has no 'metric'; expected either 'metric' or 'formula'");
  EXPECT_EQ(column("{metric: triangles, formula: 1, method: tree}").substr(0, 96),
            "x.yaml:9:24: column 'c' has both 'metric' and 'formula'; expected either 'metric' or 'formula'\nx");
  EXPECT_EQ(column("{metric: test_curve, method: tree}"),
            "x.yaml:9:36: 'test_curve' is a series over depth; expected a quantity of one number in a column; a series can be "
            "drawn by a "
            "figure");
  EXPECT_EQ(column("{metric: triangles}"),
            "x.yaml:9:36: column 'c' names no method; expected 'method', one of tree, wide, many[bins=1], many[bins=2]");
  EXPECT_EQ(column("{metric: triangles, method: many}"),
            "x.yaml:9:55: method 'many' is a sweep; expected one of many[bins=1], many[bins=2]");
  EXPECT_EQ(column("{metric: triangles, method: tre}"),
            "x.yaml:9:55: there is no method 'tre' in this experiment; expected one of tree, wide, many[bins=1], many[bins=2]; "
            "did you mean "
            "'tree'?");
  EXPECT_EQ(column("{metric: triangles, method: [tree]}"), "x.yaml:9:55: 'method' is a list; expected the name of a method");
  EXPECT_EQ(errors("tables: {t: {rows: method, columns: {c: {metric: triangles, method: tree}}}}\n"),
            "x.yaml:9:69: 'method' stands in a table whose rows are methods; expected a column without it");
  EXPECT_EQ(column("{metric: total_time, method: tree, unit: MiB}"),
            "x.yaml:9:68: column 'c' cannot be shown in 'MiB'; expected one of s, ms, us, min, h");
  EXPECT_EQ(column("{metric: total_time, method: tree, relative_to: wide, unit: s}"),
            "x.yaml:9:87: column 'c' cannot be shown in 's'; expected one of 1, %, k, M");
  EXPECT_EQ(column("{metric: total_time, method: tree, tracer: t}"),
            "x.yaml:9:36: 'total_time' does not depend on rays; expected a column without 'tracer' and 'workload'");
  EXPECT_EQ(column("{metric: trace_rate, method: tree, workload: few}"),
            "x.yaml:9:36: column 'c' names no tracer; expected 'tracer', one of t, w");
  EXPECT_EQ(column("{metric: trace_rate, method: tree, tracer: t}"),
            "x.yaml:9:36: column 'c' names no workload; expected 'workload', one of few, lots");
  EXPECT_EQ(column("{metric: trace_rate, method: tree, tracer: w, workload: few}"),
            "x.yaml:9:36: column 'c' asks for tracer 'w', which does not trace method 'tree'; expected one of t");
  EXPECT_EQ(column("{metric: triangles, method: tree, decimals: 99}"),
            "x.yaml:9:71: 'decimals' is the integer 99; expected an integer in [0, 15]");
  EXPECT_EQ(column("{formula: 1 + time}"),
            "x.yaml:9:37: the formula of column 'c' asks for 'time', which is no column before it; expected none");
  EXPECT_EQ(column("{formula: 1 +}"), "x.yaml:9:37: formula '1 +': it ends too early; expected a number, a column's name or '('");
  const std::string unknown = column("{metric: trace_rat, method: tree}");
  EXPECT_THAT(unknown,
              testing::StartsWith("x.yaml:9:36: there is no quantity 'trace_rat'; expected one of triangles, build_time, "));
  EXPECT_THAT(unknown, testing::EndsWith("; did you mean 'trace_rate'?"));
  EXPECT_EQ(errors("metrics: []\ntables: {t: {columns: {c: {metric: test_cost, method: wide}}}}\n"),
            "x.yaml:10:36: 'test_cost' is not measured by this experiment; expected metric 'test-metric' in 'metrics'");
  std::string unpublished = study + "tables: {t: {columns: {c: {metric: triangles, method: tree, published: a.b}}}}\n";
  unpublished.replace(unpublished.find("paper: insertion-bittner"), 24, "seed: 1");
  try {
    (void)parse_plan(unpublished, "x.yaml", Scale::quick);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "x.yaml:9:72: column 'c' names a published value; expected 'paper' in the experiment, the name of a file in "
                 "results/published");
  }
}

TEST(ReadFigures, CompletedFromKindAndPlan) {
  const Plan plan = read(R"(
figures:
  steps: {kind: heat-map, scenes: [conference], methods: [tree], workloads: [few, lots], tracer: t, highest: 50}
  depths: {kind: depth-histogram, caption: Fig. 7, methods: [tree, wide], styles: {tree: red dashed, wide: "#2a9d3f"}}
  growth: {kind: line, y: total_time, x: triangles, log_x: true}
)");
  ASSERT_EQ(plan.figures.size(), 3U);
  const FigureSpec& steps = plan.figures[0];
  EXPECT_EQ(steps.kind, "heat-map");
  EXPECT_THAT(steps.scenes, ElementsAre("conference"));
  EXPECT_THAT(steps.methods, ElementsAre("tree"));
  EXPECT_THAT(steps.workloads, ElementsAre("few", "lots"));
  EXPECT_EQ(steps.tracer, "t");
  EXPECT_EQ(steps.options.at("lowest"), "0");
  EXPECT_EQ(steps.options.at("highest"), "50");
  const FigureSpec& depths = plan.figures[1];
  EXPECT_EQ(depths.caption, "Fig. 7");
  EXPECT_THAT(depths.scenes, ElementsAre("sibenik-ogre", "conference"));
  EXPECT_EQ(depths.styles.at("tree"), "red dashed");
  EXPECT_EQ(depths.styles.at("wide"), "#2a9d3f");
  EXPECT_THAT(depths.workloads, IsEmpty());
  const FigureSpec& growth = plan.figures[2];
  EXPECT_EQ(growth.methods.size(), 4U);
  EXPECT_EQ(growth.options.at("log_x"), "true");
  EXPECT_EQ(growth.options.at("log_y"), "false");
}

TEST(ReadFigures, AParetoPlotTakesTracedMethodsWithTheirOwnTracers) {
  const Plan plan = read("figures: {p: {kind: pareto, scenes: [conference], workloads: few}}\n");
  EXPECT_EQ(plan.figures.at(0).tracer, own_tracer);
  EXPECT_THAT(plan.figures.at(0).methods, ElementsAre("tree", "wide", "many[bins=1]", "many[bins=2]"));
  EXPECT_EQ(
      errors("figures: {p: {kind: pareto, methods: [tree, untraced]}}\n",
             {{"  many:", "  untraced: {from: tree, tracers: []}\n  many:"}}),
      "x.yaml:10:11: figure 'p' shows the own tracer of method 'untraced', which has none; expected a method that is traced");
  EXPECT_EQ(errors("figures: {p: {kind: pareto, styles: {tree: red}}}\n"),
            "x.yaml:9:29: figure 'p' has no key 'styles'; expected one of caption, kind, scenes, methods, workloads, tracer");
  EXPECT_EQ(read("figures: {l: {kind: line, x: triangles, y: trace_time, tracer: own, workloads: few}}\n").figures.at(0).tracer,
            own_tracer);
  EXPECT_EQ(errors("figures: {l: {kind: line, x: triangles, y: trace_time, tracer: own}}\n"),
            "x.yaml:9:11: figure 'l' draws one workload and has several; expected 'workloads', one of few, lots");
}

TEST(ReadFigures, Mistakes) {
  EXPECT_EQ(errors("figures: 1\n"), "x.yaml:9:10: 'figures' is the integer 1; expected a map of name to figure");
  EXPECT_EQ(errors("figures: {f: {}}\n"),
            "x.yaml:9:14: figure 'f' has no 'kind'; expected one of heat-map, render, film-strip, depth-histogram, pareto, line");
  EXPECT_EQ(errors("figures: {f: {kind: heatmap}}\n"),
            "x.yaml:9:21: there is no kind of figure 'heatmap'; expected one of heat-map, render, film-strip, depth-histogram, "
            "pareto, line; "
            "did you mean "
            "'heat-map'?");
  EXPECT_EQ(errors("figures: {f: {kind: depth-histogram, methods: [x]}}\n"),
            "x.yaml:9:48: there is no method 'x' in this experiment; expected one of tree, wide, many[bins=1], many[bins=2]");
  EXPECT_EQ(errors("figures: {f: {kind: depth-histogram, highest: 3}}\n"),
            "x.yaml:9:38: figure 'f' has no key 'highest'; expected one of caption, kind, scenes, methods, styles");
  EXPECT_EQ(errors("figures: {f: {kind: depth-histogram, styles: red}}\n"),
            "x.yaml:9:46: 'styles' is the text 'red'; expected a map of method to style, such as 'sah: red dashed'");
  for (const std::string& style : std::vector<std::string>{"red wavy", "'#12345'", "Red!", "''"}) {
    const std::size_t quoted = style.front() == '\'' ? 1 : 0;
    EXPECT_EQ(errors("figures: {f: {kind: depth-histogram, styles: {tree: " + style + "}}}\n"),
              "x.yaml:9:53: the style of 'tree' is the text '" + style.substr(quoted, style.size() - 2 * quoted) +
                  "'; expected a colour (a name or #rrggbb), then solid, dashed or dotted, such as 'red dashed'");
  }
  EXPECT_EQ(errors("figures: {f: {kind: line, y: total_time}}\n"),
            "x.yaml:9:30: 'total_time' is one number and has no axis of its own; expected a series, or 'x: triangles'");
  EXPECT_EQ(errors("figures: {f: {kind: line, y: test_curve, x: triangles}}\n"),
            "x.yaml:9:30: 'test_curve' is a series over depth; expected a quantity of one number, or 'x: axis'");
  EXPECT_EQ(errors("figures: {f: {kind: heat-map}}\n"),
            "x.yaml:9:11: figure 'f' names no tracer; expected 'tracer', one of t, w");
  EXPECT_EQ(errors("figures: {f: {kind: heat-map, tracer: w, methods: [tree]}}\n"),
            "x.yaml:9:11: figure 'f' shows tracer 'w', which does not trace method 'tree'; expected one of t");
  EXPECT_EQ(errors("figures: {f: {kind: heat-map, tracer: t, methods: [tree], highest: x}}\n"),
            "x.yaml:9:68: 'highest' is the text 'x'; expected a number in [0, 1000000]");
  try {
    (void)parse_plan("scenes: [conference]\nmethods: {a: test-builder}\nfigures: {f: {kind: render}}\n", "x.yaml", Scale::quick);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "x.yaml:3:11: figure 'f' needs rays; expected 'workloads' in the experiment");
  }
}

TEST(Quantities, UnitsOfOneKind) {
  EXPECT_DOUBLE_EQ(unit_factor("s", "ms").value(), 1000);
  EXPECT_DOUBLE_EQ(unit_factor("bytes", "MiB").value(), 1.0 / 1048576);
  EXPECT_DOUBLE_EQ(unit_factor("rays/s", "Mrays/s").value(), 1e-6);
  EXPECT_DOUBLE_EQ(unit_factor("", "%").value(), 100);
  EXPECT_EQ(unit_factor("1", ""), 1);
  EXPECT_EQ(unit_factor("parsecs", "parsecs"), 1);
  EXPECT_EQ(unit_factor("s", "MiB"), std::nullopt);
  EXPECT_EQ(unit_factor("parsecs", "s"), std::nullopt);
  EXPECT_THAT(units_for("ms"), ElementsAre("ms", "s", "us", "min", "h"));
  EXPECT_THAT(units_for("parsecs"), ElementsAre("parsecs"));
}

}  // namespace
}  // namespace raystudy
