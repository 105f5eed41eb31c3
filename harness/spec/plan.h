#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/error.h"
#include "harness/method/params.h"
#include "harness/spec/target.h"

namespace raystudy {

/// How large the study is: `quick` for a look, `full` for a result, `paper` for the publication's own sizes.
enum class Scale : unsigned char { quick, full, paper };

/// A scene of the matrix: a catalog name, or a procedural generator with its parameters.
struct SceneSpec {
  std::string label;           ///< the row's name in tables, with its sweep point; unique in an experiment
  std::string base;            ///< the label without the sweep point
  std::string name;            ///< in the catalog, of a generator, or a file's path (with a '/')
  std::int64_t triangles = 0;  ///< of a generator
  std::uint64_t seed = 1;      ///< of a generator
  std::string identity;        ///< all that its geometry and cameras depend on, without loading it; part of cell_id
  SourceLocation where;
};

/// builder → optimizers → encoder, every stage timed on its own. Of an animation: builder and optimizers as often as the updater
/// asks for, and the encoder after every update.
struct PipelineSpec {
  std::string label;                        ///< with its sweep point, e.g. "insertion[batch=2]"; unique
  std::string base;                         ///< the name in YAML, without the sweep point
  std::map<std::string, ParamValue> sweep;  ///< the sweep point: parameter → value
  MethodRef builder;
  std::vector<MethodRef> optimizers;
  std::optional<MethodRef> updater;  ///< where the experiment plays animations, and only there
  std::optional<MethodRef> encoder;
  std::vector<std::string> tracers;  ///< labels of the tracers used with it; all that accept its accel where YAML names none
  int threads = 1;                   ///< that its stages and tracers may use; the experiment's where YAML names none
  SourceLocation where;
};

struct TracerSpec {
  std::string label;  ///< with its sweep point; unique
  std::string base;   ///< the label without it
  MethodRef tracer;
  SourceLocation where;
};

struct WorkloadSpec {
  std::string label;  ///< with its sweep point; unique
  std::string base;   ///< the label without it
  MethodRef workload;
  SourceLocation where;
};

struct CostSpec {
  double traversal = 3;     ///< c_T
  double intersection = 2;  ///< c_I
  MethodRef heuristic;      ///< surface-area unless the experiment says otherwise
};

/// How the scenes' animations are played.
struct AnimationSpec {
  std::size_t frames = 50;  ///< at equally spaced times, interpolated between key frames; the first and the last included
};

/// A point of the matrix. A build cell has neither tracer nor workload.
struct Cell {
  std::size_t scene = 0;                ///< index into Plan::scenes
  std::size_t pipeline = 0;             ///< index into Plan::pipelines
  std::optional<std::size_t> tracer;    ///< index into Plan::tracers
  std::optional<std::size_t> workload;  ///< index into Plan::workloads
};

/// In place of a tracer's label: each method's own tracer, where it has just one.
inline constexpr const char* own_tracer = "own";

/// A column of a table: a quantity (quantity.h) of one method, or of the best of several, with tracer and workload for a traced
/// one, or a formula over other columns of the table.
struct ColumnSpec {
  std::string name;     ///< key, used by formulas and in the long CSV; unique in a table
  std::string label;    ///< heading
  std::string metric;   ///< a Quantity's name, e.g. cost, total_time, trace_rate; empty for a formula
  std::string formula;  ///< e.g. "100 * cost_insertion / cost_sah", over columns before this one (formula.h); empty for a metric
  bool higher_is_better = false;         ///< of the metric: which one of several is the best
  std::vector<std::string> methods;      ///< PipelineSpec::labels, the best of which is shown; empty where the rows are methods
  std::string tracer;                    ///< TracerSpec::label or own_tracer, of a traced metric; else empty
  std::string workload;                  ///< WorkloadSpec::label, of a traced metric; else empty
  std::vector<std::string> relative_to;  ///< PipelineSpec::labels; the best of their values of the same metric divides this one
  std::map<std::string, double> at;      ///< by SceneSpec::label: where on its axis a series is read, in the axis' unit
  std::string until;  ///< a PipelineSpec::label: the value is where the series is first as low as that method's ends
  std::string unit;   ///< shown unit, the metric's own where YAML names none; empty for a pure number. "%" multiplies by 100
  int decimals = 2;
  std::string published;                  ///< key into the paper's published table, e.g. "table1.cost"
  std::map<std::string, Target> targets;  ///< by SceneSpec::label, in the shown unit; empty: there is nothing to reach
  SourceLocation where;
};

struct TableSpec {
  std::string name;
  std::string caption;
  std::string rows;         ///< "scene" or "method": what the values of one row belong to
  bool transposed = false;  ///< shown with a line for each of `columns`, rows side by side
  bool slopes = false;  ///< of each value the power of the triangles with which it grows over a sweep of scenes (SceneSpec::base)
  std::vector<std::string> row_filter;  ///< labels in the order shown; empty: all
  std::string scene;  ///< where the rows are methods: the scene (of slopes: the sweep's base); empty: the table once for each
  std::vector<ColumnSpec> columns;
  SourceLocation where;
};

/// A picture. `kind` is one of figure_kinds() (figure_kinds.h), whose options are all in `options`, completed with defaults.
struct FigureSpec {
  std::string name;
  std::string kind;  ///< heat-map, render, depth-histogram, line
  std::string caption;
  std::map<std::string, std::string> options;
  std::vector<std::string> methods;    ///< PipelineSpec labels, one picture or curve each; all where YAML names none
  std::vector<std::string> scenes;     ///< SceneSpec labels; all where YAML names none
  std::vector<std::string> workloads;  ///< WorkloadSpec labels of a traced kind (heat-map); a picture sums over them
  std::string tracer;                  ///< TracerSpec label of a traced kind
  std::map<std::string, std::string>
      styles;  ///< method label → "red dashed", "#2a9d3f solid": colour, then solid, dashed or dotted
  SourceLocation where;
};

/// A checked experiment: everything the YAML says, completed with defaults, every name resolved.
struct Plan {
  std::string file;
  std::string name;  ///< the file's name without extension
  std::string title;
  std::string paper;  ///< results/published/<paper>.yaml; empty where nothing is published
  Scale scale = Scale::quick;
  std::uint64_t seed = 1;
  int threads = 1;  ///< of the workloads, and of every pipeline that names none
  int repetitions = 3;
  double warm_up_seconds = 0;
  std::string device;             ///< the Vulkan device asked for, by name or number; empty: the best
  double timeout_seconds = 0;     ///< a cell; 0: none
  double memory_limit_bytes = 0;  ///< a cell; 0: none
  CostSpec cost;
  std::optional<AnimationSpec> animation;  ///< none: scenes stand still
  std::vector<SceneSpec> scenes;
  std::vector<PipelineSpec> pipelines;
  std::vector<TracerSpec> tracers;
  std::vector<WorkloadSpec> workloads;
  std::vector<MethodRef> metrics;
  std::vector<Cell> cells;
  std::vector<TableSpec> tables;
  std::vector<FigureSpec> figures;
};

/// "quick", "full", "paper".
[[nodiscard]] std::string_view scale_name(Scale scale);

/// Reads and checks an experiment. Throws one Error with all of the file's diagnostics, each with line and column.
[[nodiscard]] Plan read_plan(const std::string& file, Scale scale);
/// The same for text already read; `file` is the name that diagnostics show and that the plan is named after.
[[nodiscard]] Plan parse_plan(const std::string& text, const std::string& file, Scale scale);
/// Reads a file at every scale. Throws one Error with what is wrong at any of them.
void check_plan(const std::string& file);

}  // namespace raystudy
