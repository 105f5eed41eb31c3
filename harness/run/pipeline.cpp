#include "harness/run/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <type_traits>
#include <utility>

#include "harness/base/error.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

/// Runs a stage in a context that takes a device's times; returns how long it took.
template <class Stage>
double timed(const BuildContext& context, StageTimes& times, const Stage& stage) {
  DeviceTimes device;
  BuildContext own = context;
  own.device = &device;
  const auto start = std::chrono::steady_clock::now();
  stage(own);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  times.device.add(device);
  if (device.seconds) times.not_counted += seconds - *device.seconds;
  return device.seconds.value_or(seconds);
}

template <class Tree>  // Accel or const Accel
auto& as_bvh2(Tree& accel, const std::string& label, std::string_view taker) {
  using Bvh = std::conditional_t<std::is_const_v<Tree>, const Bvh2, Bvh2>;
  if (auto* bvh = dynamic_cast<Bvh*>(&accel)) return *bvh;
  throw Error(fmt::format("'{}': {} takes a bvh2, the stage before it made '{}'", label, taker, accel.kind()));
}

}  // namespace

double StageTimes::optimize_sum() const { return std::accumulate(optimize.begin(), optimize.end(), 0.0); }

Pipeline::Pipeline(const PipelineSpec& spec) : label_(spec.label) {
  const Registry& registry = Registry::instance();
  builder_ = registry.create<Builder>(spec.builder);
  for (const MethodRef& ref : spec.optimizers) {
    const auto uses = 1 + std::count_if(spec.optimizers.data(), &ref, [&ref](const MethodRef& r) { return r.name == ref.name; });
    optimizer_names_.push_back(uses == 1 ? ref.name : fmt::format("{}#{}", ref.name, uses));
    optimizers_.push_back(registry.create<Optimizer>(ref));
  }
  if (spec.encoder) encoder_ = registry.create<Encoder>(*spec.encoder);
}

std::unique_ptr<Accel> Pipeline::run(const Scene& scene, const BuildContext& context, StageTimes& times,
                                     const OnStage& on_stage) const {
  times = {};
  std::unique_ptr<Accel> accel = make_tree(scene, context, times, on_stage);
  if (encoder_) accel = encode(*accel, scene, context, times, on_stage);
  return accel;
}

std::unique_ptr<Accel> Pipeline::make_tree(const Scene& scene, const BuildContext& context, StageTimes& times,
                                           const OnStage& on_stage) const {
  const auto enter = [&on_stage](std::string_view stage) {
    if (on_stage) on_stage(stage);
  };
  times.optimize.resize(optimizers_.size(), 0);
  enter("building");
  std::unique_ptr<Accel> accel;
  times.build += timed(context, times, [&](const BuildContext& c) { accel = builder_->build(scene, c); });
  if (!accel) throw Error(fmt::format("'{}': its builder made nothing", label_));
  double before = 0;
  for (std::size_t i = 0; i < optimizers_.size(); ++i) {
    enter(fmt::format("optimizing ({})", optimizer_names_[i]));
    Bvh2& bvh = as_bvh2(*accel, label_, fmt::format("optimizer '{}'", optimizer_names_[i]));
    std::vector<CostSample> trace;
    BuildContext own = context;
    if (context.cost_trace != nullptr) own.cost_trace = &trace;
    const double seconds = timed(own, times, [&](const BuildContext& c) { optimizers_[i]->optimize(bvh, scene, c); });
    times.optimize[i] += seconds;
    for (const CostSample& sample : trace) context.cost_trace->push_back({before + sample.seconds, sample.cost});
    before += seconds;
  }
  return accel;
}

std::unique_ptr<Accel> Pipeline::encode(const Accel& tree, const Scene& scene, const BuildContext& context, StageTimes& times,
                                        const OnStage& on_stage) const {
  if (on_stage) on_stage("encoding");
  const Bvh2& bvh = as_bvh2(tree, label_, "its encoder");
  std::unique_ptr<Accel> encoded;
  times.encode += timed(context, times, [&](const BuildContext& c) { encoded = encoder_->encode(bvh, scene, c); });
  if (!encoded) throw Error(fmt::format("'{}': its encoder made nothing", label_));
  return encoded;
}

std::unique_ptr<UpdateSession> prepare_updates(const Pipeline& pipeline, const PipelineSpec& spec, const Scene& animation,
                                               std::span<const double> frames, const BuildContext& context, StageTimes& times) {
  const auto first = std::make_shared<std::vector<CostSample>*>(context.cost_trace);
  const TreeBuild build = [&pipeline, &times, context, first](const Scene& scene) {
    BuildContext own = context;
    own.cost_trace = std::exchange(*first, nullptr);
    return pipeline.make_tree(scene, own, times);
  };
  BuildContext own = context;
  own.cost_trace = nullptr;
  const auto updater = Registry::instance().create<Updater>(*spec.updater);
  std::unique_ptr<UpdateSession> session = updater->prepare(animation, frames, build, own);
  if (!session) throw Error(fmt::format("'{}': its updater prepared nothing", spec.label));
  return session;
}

CostModel make_cost_model(const CostSpec& spec, const Scene& scene, int threads, std::uint64_t seed) {
  CostModel model;
  model.traversal = static_cast<float>(spec.traversal);
  model.intersection = static_cast<float>(spec.intersection);
  if (!spec.heuristic.name.empty()) {
    BuildContext context;
    context.threads = threads;
    context.seed = seed;
    model.measure = Registry::instance().create<Heuristic>(spec.heuristic)->prepare(scene, context);
  }
  return model;
}

}  // namespace raystudy
