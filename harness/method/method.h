#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "harness/accel/accel.h"
#include "harness/accel/bvh2.h"
#include "harness/geometry/ray.h"
#include "harness/method/cost_model.h"
#include "harness/method/device_times.h"
#include "harness/method/params.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// A value that a Metric gives, as it stands in MetricValue.
struct MetricValueInfo {
  std::string name;
  std::string unit;
  std::string summary{};  ///< the metric's own where empty
  std::string axis{};     ///< MetricValue::x of a series; empty for a single number
};

/// What a method says of itself; `list`, `describe`, YAML checking and the docs all read this.
struct MethodInfo {
  std::string name;      ///< as in YAML: lower case, words joined by '-'
  std::string summary;   ///< one line
  std::string citation;  ///< the paper, with section or equation
  std::vector<ParamSpec> params{};
  std::string accel{};     ///< the Accel kind a builder or encoder makes, a tracer, optimizer or metric takes ("" takes all)
  bool on_device = false;  ///< works on a Vulkan device, and throws Unsupported where there is none
  std::vector<std::string> parts{};       ///< of a builder that works on a device: the parts of its time (DeviceTimes::parts)
  std::vector<MetricValueInfo> values{};  ///< of a metric: every value it may give; tables and figures may name these

  /// True where a parameter must name a file, so that the method does not work with its defaults.
  [[nodiscard]] bool needs_file() const {
    return std::any_of(params.begin(), params.end(), [](const ParamSpec& p) { return p.type == ParamType::file; });
  }
};

/// Cost over time while an optimizer runs: seconds since its start and the cost at that moment.
struct CostSample {
  double seconds = 0;
  double cost = 0;
};

/// What surrounds a build: how many threads it may use, its seed, the cost model, and where it may record its progress.
struct BuildContext {
  int threads = 1;
  std::uint64_t seed = 1;
  CostModel cost;
  std::vector<CostSample>* cost_trace = nullptr;  ///< filled by optimizers where not null, up to the tree that comes out
  DeviceTimes* device = nullptr;                  ///< filled by methods that work on a device, where not null
  const std::atomic<bool>* stop = nullptr;        ///< where it turns true, long work ends early with a valid result
  [[nodiscard]] bool stop_requested() const { return stop != nullptr && stop->load(std::memory_order_relaxed); }
};

class Method {
 public:
  Method() = default;
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;
  virtual ~Method() = default;
};

/// Scene → Accel. Must be deterministic for a seed, whatever the number of threads.
class Builder : public Method {
 public:
  static constexpr Role role = Role::builder;
  [[nodiscard]] virtual std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const = 0;
};

/// Bvh2 → better Bvh2, in place.
class Optimizer : public Method {
 public:
  static constexpr Role role = Role::optimizer;
  virtual void optimize(Bvh2& bvh, const Scene& scene, const BuildContext& context) const = 0;
};

/// Bvh2 → an Accel of another kind.
class Encoder : public Method {
 public:
  static constexpr Role role = Role::encoder;
  [[nodiscard]] virtual std::unique_ptr<Accel> encode(const Bvh2& bvh, const Scene& scene, const BuildContext& context) const = 0;
};

/// The tree of one frame.
struct FrameUpdate {
  const Accel* accel = nullptr;            ///< valid until the session is asked again
  bool rebuilt = false;                    ///< built anew for this frame, not refitted
  std::optional<double> device_seconds{};  ///< where the update was done on a device: by its clock, in place of the wall's
};

/// An animation being played frame by frame. What it was prepared with must outlive it.
class UpdateSession {
 public:
  UpdateSession() = default;
  UpdateSession(const UpdateSession&) = delete;
  UpdateSession& operator=(const UpdateSession&) = delete;
  virtual ~UpdateSession() = default;

  /// Makes the tree ready for frame `index` of those it was prepared for, whose scene is `frame`. Frames come in order from 0;
  /// frame 0 begins the animation anew. This is what is timed as the update of a frame.
  virtual FrameUpdate update(const Scene& frame, std::size_t index) = 0;
  /// Bytes of all trees that are held.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

/// Builds and optimizes a tree for a scene, as the method's pipeline says (the encoder comes after the update).
using TreeBuild = std::function<std::unique_ptr<Accel>(const Scene& scene)>;

/// Animation → the trees of its frames: by refitting one, by building others.
class Updater : public Method {
 public:
  static constexpr Role role = Role::updater;
  /// What is done before the animation is played: `build` with one scene or many. `animation` has its key frames, and the
  /// vertices of the first; `times` (in [0, 1], ascending) are those of the frames to come.
  [[nodiscard]] virtual std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> times,
                                                               const TreeBuild& build, const BuildContext& context) const = 0;
};

/// Scene → Measure.
class Heuristic : public Method {
 public:
  static constexpr Role role = Role::heuristic;
  [[nodiscard]] virtual std::shared_ptr<const Measure> prepare(const Scene& scene, const BuildContext& context) const = 0;
};

/// Sums over the rays of a counting pass.
struct TraceCounts {
  std::uint64_t inner_nodes = 0;     ///< inner nodes visited
  std::uint64_t leaves = 0;          ///< leaves visited
  std::uint64_t box_tests = 0;       ///< boxes tested against a ray
  std::uint64_t triangle_tests = 0;  ///< triangles tested against a ray
  [[nodiscard]] std::uint64_t traversal_steps() const { return inner_nodes + leaves; }
};

/// A tracer made ready for one Accel. The scene and the Accel must outlive it.
class TraceSession {
 public:
  TraceSession() = default;
  TraceSession(const TraceSession&) = delete;
  TraceSession& operator=(const TraceSession&) = delete;
  virtual ~TraceSession() = default;

  /// hits.size() == rays.size(); hits come back in the order of the rays. Timed: nothing is counted here.
  virtual void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) = 0;
  /// Of the last call of `trace`, where it worked on a device; nullptr for all others.
  [[nodiscard]] virtual const DeviceTimes* device_times() const { return nullptr; }
  /// False where rays may slip between triangles that share an edge or a corner (Embree: with its robust flag very rarely).
  [[nodiscard]] virtual bool watertight() const { return true; }
  /// True where `count` is implemented (Embree cannot count).
  [[nodiscard]] virtual bool counts() const { return false; }
  /// The instrumented pass of the same traversal. `steps`, where not empty, gets each ray's traversal steps.
  virtual TraceCounts count(std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps);
};

/// Accel + rays → hits.
class Tracer : public Method {
 public:
  static constexpr Role role = Role::tracer;
  /// `coherent` tells that neighbouring rays go the same way (primary rays).
  [[nodiscard]] virtual std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene& scene, int threads,
                                                              bool coherent) const = 0;
};

/// The rays of a workload, made once per scene and camera and given to every tracer.
struct RayBatch {
  std::vector<Ray> rays;
  Query query = Query::closest_hit;
  bool coherent = false;
  std::uint32_t width = 0;  ///< image size where the rays belong to pixels, else 0
  std::uint32_t height = 0;
  std::vector<std::uint32_t> ray_pixels{};  ///< pixel (y · width + x) of each ray; empty: ray i is pixel i
};

struct WorkloadContext {
  std::uint64_t seed = 1;
  /// Closest hits by the reference tracer, for workloads whose rays start where others end.
  std::function<void(std::span<const Ray>, std::span<Hit>)> closest_hits;
};

/// Scene + camera → rays.
class Workload : public Method {
 public:
  static constexpr Role role = Role::workload;
  [[nodiscard]] virtual RayBatch generate(const Scene& scene, const WorkloadContext& context) const = 0;
};

/// A figure (or, with `x`, a series) that a Metric found. Always of class `exact`: a pure function of tree, scene and cost model.
struct MetricValue {
  std::string name;
  std::string unit;
  std::vector<double> values;  ///< one number, or one a step of `x`
  std::string x{};             ///< what a series runs over, e.g. "depth"; empty for a single number
};

/// Accel → numbers.
class Metric : public Method {
 public:
  static constexpr Role role = Role::metric;
  [[nodiscard]] virtual std::vector<MetricValue> measure(const Accel& accel, const Scene& scene,
                                                         const BuildContext& context) const = 0;
};

}  // namespace raystudy
