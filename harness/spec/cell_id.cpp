#include "harness/spec/cell_id.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "harness/method/registry.h"

namespace raystudy {
namespace {

std::string hex(XXH128_hash_t hash) { return fmt::format("{:016x}{:016x}", hash.high64, hash.low64); }

/// The plugin files that a method and the methods among its parameters come from.
void collect_origins(Role role, const MethodRef& ref, std::set<std::string>& origins) {
  const Registry::Entry* entry = Registry::instance().find(role, ref.name);
  if (entry == nullptr) return;
  if (entry->origin != "built in") origins.insert(entry->origin);
  if (!ref.params) return;
  for (const ParamSpec& spec : entry->info.params) {
    if (spec.type == ParamType::method) collect_origins(spec.role, ref.params->method(spec.name), origins);
  }
}

bool on_device(Role role, const MethodRef& ref) {
  const Registry::Entry* entry = Registry::instance().find(role, ref.name);
  if (entry == nullptr) return false;
  if (entry->info.on_device || !ref.params) return entry->info.on_device;
  return std::any_of(entry->info.params.begin(), entry->info.params.end(), [&ref](const ParamSpec& spec) {
    return spec.type == ParamType::method && on_device(spec.role, ref.params->method(spec.name));
  });
}

/// A plugin is read once: it stays loaded, so its file is not looked at again.
std::string plugin_hash(const std::string& path) {
  static std::mutex mutex;
  static std::map<std::string, std::string> known;
  const std::lock_guard lock(mutex);
  auto found = known.find(path);
  if (found == known.end()) found = known.emplace(path, file_hash(path).value_or("none")).first;
  return found->second;
}

class Identity {
 public:
  void add(std::string_view key, const std::string& value) { text_ += fmt::format("{}: {}\n", key, value); }
  void add(Role role, const MethodRef& ref) {
    add(role_name(role), canonical(ref));
    collect_origins(role, ref, origins_);
  }
  std::string finish() {
    for (const std::string& origin : origins_) add("plugin", plugin_hash(origin));
    return std::move(text_);
  }

 private:
  std::string text_;
  std::set<std::string> origins_;
};

}  // namespace

bool uses_device(const Plan& plan, const Cell& cell) {
  const PipelineSpec& pipeline = plan.pipelines.at(cell.pipeline);
  const auto optimizes = [](const MethodRef& ref) { return on_device(Role::optimizer, ref); };
  return on_device(Role::builder, pipeline.builder) ||
         std::any_of(pipeline.optimizers.begin(), pipeline.optimizers.end(), optimizes) ||
         (pipeline.encoder && on_device(Role::encoder, *pipeline.encoder)) ||
         (pipeline.updater && on_device(Role::updater, *pipeline.updater)) ||
         (cell.tracer && on_device(Role::tracer, plan.tracers.at(*cell.tracer).tracer));
}

std::string cell_identity(const Plan& plan, const Cell& cell) {
  const SceneSpec& scene = plan.scenes.at(cell.scene);
  const PipelineSpec& pipeline = plan.pipelines.at(cell.pipeline);
  Identity identity;
  identity.add("scene", fmt::format("{} = {}", scene.label, scene.identity));
  identity.add("method", pipeline.label);
  identity.add(Role::builder, pipeline.builder);
  for (const MethodRef& optimizer : pipeline.optimizers) identity.add(Role::optimizer, optimizer);
  if (pipeline.updater) identity.add(Role::updater, *pipeline.updater);
  if (plan.animation) identity.add("frames", fmt::format("{}", plan.animation->frames));
  if (pipeline.encoder) identity.add(Role::encoder, *pipeline.encoder);
  identity.add("cost", fmt::format("c_T={} c_I={}", plan.cost.traversal, plan.cost.intersection));
  identity.add(Role::heuristic, plan.cost.heuristic);
  if (cell.tracer) {
    identity.add("tracer label", plan.tracers.at(*cell.tracer).label);
    identity.add(Role::tracer, plan.tracers.at(*cell.tracer).tracer);
  }
  if (cell.workload) {
    identity.add("workload label", plan.workloads.at(*cell.workload).label);
    identity.add(Role::workload, plan.workloads.at(*cell.workload).workload);
  }
  if (!cell.tracer) {  // metrics look at what was built
    for (const MethodRef& metric : plan.metrics) identity.add(Role::metric, metric);
  }
  identity.add("seed", fmt::format("{}", plan.seed));
  identity.add("threads", fmt::format("{}", pipeline.threads));
  // The rays are found with the experiment's threads, which changes none of them.
  identity.add("repetitions", fmt::format("{}", plan.repetitions));
  identity.add("warm_up", fmt::format("{} s", plan.warm_up_seconds));
  if (!plan.device.empty() && uses_device(plan, cell)) identity.add("device", plan.device);
  identity.add("code", std::string(code_hash()));
  return identity.finish();
}

std::string cell_id(const Plan& plan, const Cell& cell) {
  const std::string text = cell_identity(plan, cell);
  return hex(XXH3_128bits(text.data(), text.size()));
}

std::optional<std::string> file_hash(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
  if (!file || !state || XXH3_128bits_reset(state.get()) != XXH_OK) return std::nullopt;
  std::vector<char> part(1 << 20);
  std::size_t size = 0;
  while ((size = std::fread(part.data(), 1, part.size(), file.get())) > 0) {
    if (XXH3_128bits_update(state.get(), part.data(), size) != XXH_OK) return std::nullopt;
  }
  if (std::ferror(file.get()) != 0) return std::nullopt;
  return hex(XXH3_128bits_digest(state.get()));
}

}  // namespace raystudy
