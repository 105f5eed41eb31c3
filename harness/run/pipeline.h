#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "harness/method/method.h"
#include "harness/spec/plan.h"

namespace raystudy {

/// Seconds of a pipeline's stages, by the clock on the wall; of a stage that works on a device, by the device's.
struct StageTimes {
  double build = 0;
  std::vector<double> optimize;  ///< one an optimizer, in order
  double encode = 0;
  DeviceTimes device{};    ///< of all stages together
  double not_counted = 0;  ///< seconds by the wall clock of stages on a device, less those of the device
  [[nodiscard]] double optimize_sum() const;
  [[nodiscard]] double total() const { return build + optimize_sum() + encode; }
};

/// builder → optimizers → encoder, made ready to run any number of times.
class Pipeline {
 public:
  /// Creates the methods. Throws Error for a name or parameter the registry refuses.
  explicit Pipeline(const PipelineSpec& spec);

  /// Told before each stage what comes: "building", "optimizing (insertion)", "encoding". Its time is not counted.
  using OnStage = std::function<void(std::string_view)>;

  /// Runs every stage, each timed on its own. Throws Error where an optimizer or encoder is given something else than a Bvh2, or
  /// what a method throws. `context.cost_trace`, where not null, gets all optimizers' samples, on one time axis from the first
  /// optimizer's start.
  [[nodiscard]] std::unique_ptr<Accel> run(const Scene& scene, const BuildContext& context, StageTimes& times,
                                           const OnStage& on_stage = {}) const;

  /// The builder and the optimizers only; their times are added to `times`.
  [[nodiscard]] std::unique_ptr<Accel> make_tree(const Scene& scene, const BuildContext& context, StageTimes& times,
                                                 const OnStage& on_stage = {}) const;
  /// What the encoder makes of a tree; its time is added to `times`. Throws Error for a tree that is no Bvh2.
  [[nodiscard]] std::unique_ptr<Accel> encode(const Accel& tree, const Scene& scene, const BuildContext& context,
                                              StageTimes& times, const OnStage& on_stage = {}) const;

  [[nodiscard]] bool has_encoder() const { return encoder_ != nullptr; }
  /// Names of the optimizers in order, a repeated one with its count: insertion, insertion#2.
  [[nodiscard]] const std::vector<std::string>& optimizer_names() const { return optimizer_names_; }

 private:
  std::string label_;
  std::unique_ptr<Builder> builder_;
  std::vector<std::unique_ptr<Optimizer>> optimizers_;
  std::vector<std::string> optimizer_names_;
  std::unique_ptr<Encoder> encoder_;
};

/// The updater of `spec`, prepared: its trees are made by `pipeline`, and their times added to `times`, which must outlive the
/// session as `pipeline` must. `context.cost_trace` gets the samples of the first tree. Throws Error where nothing was prepared.
[[nodiscard]] std::unique_ptr<UpdateSession> prepare_updates(const Pipeline& pipeline, const PipelineSpec& spec,
                                                             const Scene& animation, std::span<const double> frames,
                                                             const BuildContext& context, StageTimes& times);

/// The cost model of an experiment on a scene, its heuristic prepared there.
[[nodiscard]] CostModel make_cost_model(const CostSpec& spec, const Scene& scene, int threads, std::uint64_t seed);

}  // namespace raystudy
