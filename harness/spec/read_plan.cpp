#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "harness/method/registry.h"
#include "harness/spec/cells.h"
#include "harness/spec/plan.h"
#include "harness/spec/read_method.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

const std::vector<std::pair<std::string, double>> size_units{
    {"B", 1}, {"KiB", 1024}, {"MiB", 1048576}, {"GiB", 1073741824}, {"TiB", 1099511627776}};

void read_settings(Fields& fields, Plan& plan) {
  plan.title = fields.text("title", plan.name);
  plan.paper = fields.text("paper");
  plan.seed = static_cast<std::uint64_t>(std::get<std::int64_t>(fields.value(integer_param("seed", 1, "", 0, infinity))));
  plan.threads = static_cast<int>(std::get<std::int64_t>(fields.value(threads_param(1))));
  plan.repetitions = static_cast<int>(std::get<std::int64_t>(fields.value(integer_param("repetitions", 3, "", 1, 100000))));
  plan.warm_up_seconds = fields.quantity("warm_up", 0, time_units(), "0.1 s");
  plan.timeout_seconds = fields.quantity("timeout", 0, time_units(), "10 min");
  plan.memory_limit_bytes = fields.quantity("memory_limit", 0, size_units, "4 GiB");
}

void read_cost(Reading& reading, const YamlNode* node, Plan& plan) {
  if (node != nullptr) {
    Fields fields(reading, *node, "'cost'");
    plan.cost.traversal = std::get<double>(fields.value(real_param("c_T", 3, "", 0, 1e6)));
    plan.cost.intersection = std::get<double>(fields.value(real_param("c_I", 2, "", 0, 1e6)));
    if (const YamlNode* heuristic = fields.find("heuristic")) {
      std::vector<MethodChoice> choices = read_method(reading, *heuristic, Role::heuristic, "heuristic");
      if (choices.size() == 1) plan.cost.heuristic = choices.front().ref;
      if (choices.size() > 1) {
        reading.report(heuristic->where, "the cost model's heuristic is a sweep",
                       "one heuristic: all methods are measured by one cost");
      }
    }
    fields.finish();
  }
  if (plan.cost.heuristic.name.empty() && Registry::instance().find(Role::heuristic, "surface-area") != nullptr) {
    plan.cost.heuristic = Registry::instance().ref(Role::heuristic, "surface-area");
  }
}

void read_animation(Reading& reading, const YamlNode& node, Plan& plan) {
  Fields fields(reading, node, "'animation'");
  if (!fields.is_map()) return;
  AnimationSpec animation;
  animation.frames = static_cast<std::size_t>(
      std::get<std::int64_t>(fields.value(integer_param("frames", static_cast<std::int64_t>(animation.frames), "", 1, 1e6))));
  plan.animation = animation;
  fields.finish();
}

/// Rays need both who traces them and what they are; and a tracer that traces nothing is a mistake.
void check_tracing(Reading& reading, const YamlNode* tracers, const YamlNode* workloads, const Plan& plan) {
  const bool no_tracers = tracers == nullptr || plan.tracers.empty();
  const bool no_workloads = workloads == nullptr || plan.workloads.empty();
  if (tracers == nullptr && workloads != nullptr) {
    reading.report(workloads->where, "there are workloads but no tracers", "'tracers', such as '[scalar]'");
  }
  if (tracers != nullptr && workloads == nullptr) {
    reading.report(tracers->where, "there are tracers but no workloads", "'workloads', such as '[primary]'");
  }
  if (no_tracers || no_workloads || plan.pipelines.empty()) return;
  for (const TracerSpec& tracer : plan.tracers) {
    const auto uses = [&tracer](const PipelineSpec& p) {
      return std::find(p.tracers.begin(), p.tracers.end(), tracer.label) != p.tracers.end();
    };
    if (std::any_of(plan.pipelines.begin(), plan.pipelines.end(), uses)) continue;
    reading.report(tracer.where, fmt::format("tracer '{}' traces no method of this experiment", tracer.label),
                   fmt::format("a method that makes '{}' and does not leave this tracer out",
                               Registry::instance().get(Role::tracer, tracer.tracer.name).info.accel));
  }
}

void read_experiment(Reading& reading, const YamlNode& root, Plan& plan) {
  if (root.is_null()) {
    reading.report({plan.file, 0, 0}, "the file is empty", "an experiment: a map with 'scenes' and 'methods'");
    return;
  }
  Fields fields(reading, root, "the experiment");
  if (!fields.is_map()) return;
  read_settings(fields, plan);
  read_cost(reading, fields.find("cost"), plan);
  if (const YamlNode* animation = fields.find("animation")) read_animation(reading, *animation, plan);
  if (const YamlNode* scenes = fields.require("scenes", "a list of scenes")) read_scenes(reading, *scenes, plan);
  const YamlNode* tracers = fields.find("tracers");
  if (tracers != nullptr) read_tracers(reading, *tracers, plan);
  const YamlNode* workloads = fields.find("workloads");
  if (workloads != nullptr) read_workloads(reading, *workloads, plan);
  const std::size_t before = reading.problems.size();
  if (const YamlNode* methods = fields.require("methods", "a map of name to pipeline")) read_pipelines(reading, *methods, plan);
  // Where a tracer or a method is wrong itself, what misses it is no news.
  if (reading.problems.size() == before) check_tracing(reading, tracers, workloads, plan);
  read_metrics(reading, fields.find("metrics"), plan);
  plan.cells = expand_cells(plan);
  if (const YamlNode* tables = fields.find("tables")) read_tables(reading, *tables, plan);
  if (const YamlNode* figures = fields.find("figures")) read_figures(reading, *figures, plan);
  fields.finish();
}

/// In the order of the file, each once: a mistake in a list that is a sweep is met once a point, one at every scale three times.
void sort_and_unite(std::vector<Diagnostic>& problems) {
  const auto place = [](const Diagnostic& d) { return std::tie(d.where.line, d.where.column); };
  std::stable_sort(problems.begin(), problems.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  std::set<std::string> seen;
  std::vector<Diagnostic> once;
  for (Diagnostic& problem : problems) {
    if (seen.insert(problem.text()).second) once.push_back(std::move(problem));
  }
  problems = std::move(once);
}

Plan read_tree(const std::shared_ptr<const YamlNode>& root, std::vector<Diagnostic> problems, const std::string& file,
               Scale scale) {
  Plan plan;
  plan.file = file;
  plan.name = std::filesystem::path(file).stem().string();
  plan.scale = scale;
  Reading reading{scale, std::move(problems)};
  read_experiment(reading, *root, plan);
  sort_and_unite(reading.problems);
  if (!reading.problems.empty()) throw Error(std::move(reading.problems));
  return plan;
}

}  // namespace

std::string_view scale_name(Scale scale) {
  switch (scale) {
    case Scale::quick: return "quick";
    case Scale::full: return "full";
    case Scale::paper: return "paper";
  }
  return "";
}

Plan read_plan(const std::string& file, Scale scale) {
  std::vector<Diagnostic> problems;
  const auto root = read_yaml(file, problems);
  return read_tree(root, std::move(problems), file, scale);
}

Plan parse_plan(const std::string& text, const std::string& file, Scale scale) {
  std::vector<Diagnostic> problems;
  const auto root = parse_yaml(text, file, problems);
  return read_tree(root, std::move(problems), file, scale);
}

void check_plan(const std::string& file) {
  std::vector<Diagnostic> problems;
  const auto root = read_yaml(file, problems);
  std::vector<Diagnostic> all;
  for (const Scale scale : {Scale::quick, Scale::full, Scale::paper}) {
    try {
      (void)read_tree(root, problems, file, scale);
    } catch (const Error& error) {
      all.insert(all.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  sort_and_unite(all);
  if (!all.empty()) throw Error(std::move(all));
}

}  // namespace raystudy
