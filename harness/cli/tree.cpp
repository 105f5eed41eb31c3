// tree save | load | info
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "harness/accel/tree_file.h"
#include "harness/accel/wide_bvh.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/cli/verb.h"
#include "harness/method/registry.h"
#include "harness/method/tree_figures.h"
#include "harness/run/oracle.h"
#include "harness/run/pipeline.h"
#include "harness/run/provenance.h"
#include "harness/scene/open.h"
#include "harness/scene/procedural.h"
#include "harness/spec/cell_id.h"
#include "harness/spec/parse_pipeline.h"
#include "harness/vulkan/device.h"

namespace raystudy::cli {
namespace {

struct Options {
  std::string file;
  std::string scene;
  std::int64_t triangles = 100'000;
  std::uint64_t seed = 1;
  PipelineText pipeline{.builder = "sweep-sah"};
  float traversal = 3;
  float intersection = 2;
  std::string heuristic = "surface-area";
  std::int64_t rays = 4096;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

void declare_scene(CLI::App& app, Options& o) {
  app.add_option("--triangles", o.triangles, "Of a procedural scene")->capture_default_str();
  app.add_option("--threads", o.threads, "Threads")->capture_default_str()->check(CLI::Range(1, 1024));
}

void declare_costs(CLI::App& app, Options& o) {
  app.add_option("--c_T", o.traversal, "Cost of an inner node")->capture_default_str()->check(CLI::Range(0.0, 1e6));
  app.add_option("--c_I", o.intersection, "Cost of a triangle")->capture_default_str()->check(CLI::Range(0.0, 1e6));
}

std::string form_of(const Accel& tree) {
  const auto* wide = dynamic_cast<const WideBvh*>(&tree);
  if (wide == nullptr) return std::string(tree.kind());
  return fmt::format("{} of {} children a node, {} boxes", tree.kind(), wide->width(), wide->quantized() ? "8-bit" : "float");
}

/// Everything that a file says, and what its tree costs under `model`.
void print_tree(const std::string& name, const TreeFile& file, const CostModel& model) {
  const auto line = [](std::string_view title, const std::string& text) { fmt::print("{:<12} {}\n", title, text); };
  const TreeFigures figures = tree_figures(*file.tree, model);
  line("file", fmt::format("{}, {} bytes, version {}", name, file.bytes, tree_file_version));
  line("tree", form_of(*file.tree));
  line("scene", fmt::format("{}, {} triangles, hash {}", file.scene, file.scene_triangles, file.scene_hash));
  line("inner nodes", fmt::format("{}", figures.inner_nodes));
  line("leaves", fmt::format("{}", figures.leaves));
  line("references", fmt::format("{} to triangles", figures.references));
  line("depth", fmt::format("{}", figures.depth));
  line("memory", bytes_text(static_cast<double>(file.tree->bytes())));
  line("cost", fmt::format("{:.4f} (c_T = {}, c_I = {}, surface area)", figures.cost, model.traversal, model.intersection));
  line("made under", fmt::format("c_T = {}, c_I = {}, {}", file.notes.traversal, file.notes.intersection, file.notes.heuristic));
  fmt::print("{}", file.notes.provenance);
}

/// What is needed to make the tree again.
std::string provenance(const Options& o, const PipelineSpec& spec) {
  std::string text;
  const auto add = [&text](std::string_view key, const std::string& value) { text += fmt::format("{:<12} {}\n", key, value); };
  if (find_procedural(o.scene) != nullptr) {
    add("made with", fmt::format("--triangles {}", o.triangles));
  }
  add("seed", fmt::format("{}", o.seed));
  add("builder", canonical(spec.builder));
  for (const MethodRef& optimizer : spec.optimizers) add("optimizer", canonical(optimizer));
  if (spec.encoder) add("encoder", canonical(*spec.encoder));
  const BuildInfo& build = build_info();
  add("commit", build.dirty == "yes" ? build.commit + ", with changes" : build.commit);
  add("code", std::string(code_hash()));
  add("compiler", build.compiler);
  return text;
}

void require_saveable(const PipelineSpec& spec) {
  const Registry& registry = Registry::instance();
  const bool encoded = spec.encoder.has_value();
  const Role role = encoded ? Role::encoder : Role::builder;
  const std::string& name = encoded ? spec.encoder->name : spec.builder.name;
  const std::string& kind = registry.get(role, name).info.accel;
  if (is_saveable(kind)) return;
  throw Error(Diagnostic{
      {}, fmt::format("what {} '{}' makes ('{}') cannot be saved", role_name(role), name, kind), "a bvh2 or a wide-bvh", {}});
}

int save(const Options& o) {
  const PipelineSpec spec = parse_pipeline(o.pipeline);
  require_saveable(spec);
  const CostSpec cost{o.traversal, o.intersection, Registry::instance().ref(Role::heuristic, o.heuristic)};
  const std::filesystem::path folder = std::filesystem::path(o.file).parent_path();
  require_writable_folder(folder.empty() ? "." : folder);
  {
    Progress progress("tree save", 1);
    progress.update(0, "opening the scene");
    const Scene scene = open_scene(o.scene, o.triangles, o.seed);
    BuildContext context;
    context.threads = o.threads;
    context.seed = o.seed;
    context.cost = make_cost_model(cost, scene, o.threads, o.seed);
    StageTimes times;
    const auto tree =
        Pipeline(spec).run(scene, context, times, [&progress](std::string_view stage) { progress.update(0, stage); });
    progress.update(0, "saving");
    save_tree(o.file, *tree, scene, {o.traversal, o.intersection, canonical(cost.heuristic), provenance(o, spec)});
  }
  print_tree(o.file, read_tree(o.file), {.traversal = o.traversal, .intersection = o.intersection});
  return exit_ok;
}

int info(const Options& o, const CLI::App& app) {
  const TreeFile file = read_tree(o.file);
  CostModel model{.traversal = file.notes.traversal, .intersection = file.notes.intersection};
  if (app.count("--c_T") > 0) model.traversal = o.traversal;
  if (app.count("--c_I") > 0) model.intersection = o.intersection;
  print_tree(o.file, file, model);
  return exit_ok;
}

/// Traces rays with every tracer that takes the tree, and asks the oracle. A valid tree gives right hits, or a tracer is wrong.
void prove_usable(const Accel& tree, const Scene& scene, const Options& o) {
  const Registry& registry = Registry::instance();
  const MethodRef workload = registry.ref(Role::workload, "random", {{"count", o.rays}});
  const RayBatch batch = registry.create<Workload>(workload)->generate(scene, {.seed = o.seed, .closest_hits = {}});
  std::vector<Hit> reference(batch.rays.size());
  ReferenceTracer(scene, o.threads).trace(batch.rays, reference, Query::closest_hit);
  Oracle oracle(scene);
  for (const std::string& name : registry.names(Role::tracer)) {
    const MethodInfo& info = registry.get(Role::tracer, name).info;
    if (info.accel != tree.kind()) continue;
    if (info.on_device && vulkan::list_devices().empty()) {
      fmt::print("{:<12} {}: there is no Vulkan device on this machine\n", "not traced", name);
      continue;
    }
    const auto tracer = registry.create<Tracer>(registry.ref(Role::tracer, name));
    const auto session = tracer->prepare(tree, scene, o.threads, false);
    for (const Query query : {Query::closest_hit, Query::any_hit}) {
      std::vector<Hit> hits(batch.rays.size());
      session->trace(batch.rays, hits, query);
      const OracleReport report = oracle.check(batch.rays, hits, reference, query, session->watertight());
      if (!report.ok()) throw std::logic_error(fmt::format("tracer '{}': {}", name, report.text(batch.rays, query)));
    }
    fmt::print("{:<12} {}: closest and any hits of {} random rays are right\n", "traced by", name, batch.rays.size());
  }
}

int load(const Options& o) {
  const Scene scene = open_scene(o.scene, o.triangles, o.seed);
  const TreeFile file = load_tree(o.file, scene);
  print_tree(o.file, file, {.traversal = file.notes.traversal, .intersection = file.notes.intersection});
  fmt::print("{:<12} over scene '{}'\n", "valid", scene.name);
  prove_usable(*file.tree, scene, o);
  return exit_ok;
}

void declare_save(CLI::App& app, Options& o) {
  app.add_option("scene", o.scene, "A scene of the catalog, a procedural one, or a file (a name with a '/')")->required();
  app.add_option("file", o.file, "The tree file to write")->required();
  app.add_option("--builder", o.pipeline.builder, "As in an experiment: NAME, or 'NAME: {parameter: value}'")
      ->capture_default_str();
  app.add_option("--optimize", o.pipeline.optimizers, "An optimizer; again for each further one, in order")
      ->allow_extra_args(false);
  app.add_option("--encode", o.pipeline.encoder, "An encoder; without one, the binary tree is saved");
  app.add_option("--heuristic", o.heuristic, "Of the cost model")->capture_default_str();
  app.add_option("--seed", o.seed, "Of a procedural scene and of methods")->capture_default_str();
  declare_costs(app, o);
  declare_scene(app, o);
}

void declare_load(CLI::App& app, Options& o) {
  app.add_option("file", o.file, "A tree file")->required();
  app.add_option("--scene", o.scene, "The scene that the tree is over")->required();
  app.add_option("--rays", o.rays, "Traced to prove the tree usable")->capture_default_str()->check(CLI::Range(1, 100'000'000));
  app.add_option("--seed", o.seed, "Of a procedural scene and of the rays")->capture_default_str();
  declare_scene(app, o);
}

std::function<int()> setup(CLI::App& app) {
  auto options = std::make_shared<Options>();
  auto action = std::make_shared<std::function<int()>>();
  app.require_subcommand(1);
  CLI::App* save_verb = app.add_subcommand("save", "Builds a tree and writes it to a file");
  declare_save(*save_verb, *options);
  save_verb->callback([=] { *action = [options] { return save(*options); }; });
  CLI::App* load_verb =
      app.add_subcommand("load", "Reads a tree, checks it against its scene, and traces rays through it against the oracle");
  declare_load(*load_verb, *options);
  load_verb->callback([=] { *action = [options] { return load(*options); }; });
  CLI::App* info_verb = app.add_subcommand("info", "What a tree file holds, without its scene");
  info_verb->add_option("file", options->file, "A tree file")->required();
  declare_costs(*info_verb, *options);
  info_verb->callback([=] { *action = [options, info_verb] { return info(*options, *info_verb); }; });
  return [action] { return (*action)(); };
}

const Verb verb{"tree", "Trees as files: save, load, info", setup};

}  // namespace
}  // namespace raystudy::cli
