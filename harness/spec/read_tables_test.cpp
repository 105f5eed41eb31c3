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

std::string errors(const std::string& rest) {
  try {
    (void)read(rest);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// A table on line 9 whose column `c` begins at letter 28.
std::string column(const std::string& text) { return errors("tables: {t: {columns: {c: " + text + "}}}\n"); }

TEST(ReadTables, AMethodsOwnTracerWhereRowsAreMethods) {
  const Plan plan = read("tables: {t: {rows: method, columns: {c: {metric: trace_rate, tracer: own, workload: few}}}}\n");
  EXPECT_EQ(plan.tables[0].columns[0].tracer, own_tracer);
  EXPECT_THAT(column("{metric: trace_rate, method: tree, tracer: own, workload: few}"), testing::HasSubstr("tracer 'own'"));
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
  EXPECT_EQ(one.columns[1].method, "many[bins=2]");
  EXPECT_EQ(one.columns[1].relative_to, "tree");
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
  EXPECT_EQ(two.columns[0].method, "");
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
            "x.yaml:9:21: 'scene' stands in a table whose rows are scenes; expected 'only' to choose rows");
  EXPECT_EQ(errors("tables: {t: {only: [sibenik], columns: {a: {metric: triangles, method: tree}}}}\n"),
            "x.yaml:9:21: there is no scene 'sibenik' in this experiment; expected one of sibenik-ogre, conference");
  EXPECT_EQ(errors("tables: {t: {rows: method, columns: [triangles], colum: red}}\n"),
            "x.yaml:9:50: table 't' has no key 'colum'; expected one of caption, rows, only, scene, tracer, workload, columns; "
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

TEST(ReadFigures, Mistakes) {
  EXPECT_EQ(errors("figures: 1\n"), "x.yaml:9:10: 'figures' is the integer 1; expected a map of name to figure");
  EXPECT_EQ(errors("figures: {f: {}}\n"),
            "x.yaml:9:14: figure 'f' has no 'kind'; expected one of heat-map, render, depth-histogram, line");
  EXPECT_EQ(
      errors("figures: {f: {kind: heatmap}}\n"),
      "x.yaml:9:21: there is no kind of figure 'heatmap'; expected one of heat-map, render, depth-histogram, line; did you mean "
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
