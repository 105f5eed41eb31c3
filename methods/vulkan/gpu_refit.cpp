#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/updates/refit_session.h"
#include "methods/vulkan/device_refit.h"
#include "methods/vulkan/device_shape.h"

namespace raystudy::gpu {
namespace {

struct InterpolatePush {
  std::uint64_t before;
  std::uint64_t after;
  std::uint64_t to;
  std::uint32_t count;
  float share;
};

std::size_t vertex_bytes(const Scene& scene) { return scene.vertices.size() * sizeof(Vec3); }

/// Positions of an animation's vertices on a device: key frames and what lies between two, or what the host gives.
class DevicePositions {
 public:
  /// `key_frames` are uploaded, or none where the host interpolates.
  DevicePositions(vulkan::Device& device, const Scene& animation, bool interpolate)
      : vertex_count_(static_cast<std::uint32_t>(animation.vertices.size())),
        positions_(device, vertex_bytes(animation)),
        group_(shape_of(device).group),
        kernel_(device.kernel("interpolate", {group_})) {
    if (!interpolate) return;
    const auto add = [&](const SharedArray<Vec3>& positions) {
      key_frames_.push_back(std::make_unique<vulkan::Buffer>(device, vertex_bytes(animation)));
      vulkan::upload(device, key_frames_.back()->all(), std::span<const Vec3>(positions.data(), positions.size()));
    };
    for (const SharedArray<Vec3>& frame : animation.frames) add(frame);
    if (animation.frames.empty()) add(animation.vertices);
  }

  /// Where they are to be uploaded to.
  [[nodiscard]] vulkan::Slice from_host() const { return positions_.all(); }
  /// Of the key frame itself, or interpolated by `commands`.
  [[nodiscard]] vulkan::Slice record(vulkan::Commands& commands, const KeyPosition& at) const {
    if (at.share == 0) return key_frames_[at.key]->all();
    commands.run(kernel_,
                 InterpolatePush{key_frames_[at.key]->address(), key_frames_[at.key + 1]->address(), positions_.address(),
                                 vertex_count_, at.share},
                 groups_for(vertex_count_, group_));
    commands.barrier();
    return positions_.all();
  }

 private:
  std::uint32_t vertex_count_;
  vulkan::Buffer positions_;
  std::vector<std::unique_ptr<vulkan::Buffer>> key_frames_;
  std::uint32_t group_;
  const vulkan::Kernel& kernel_;
};

class GpuRefitSession final : public UpdateSession {
 public:
  GpuRefitSession(vulkan::Device& device, std::unique_ptr<Bvh2> bvh, const Scene& animation, std::span<const double> times,
                  DeviceRefitMethod method, bool interpolate)
      : device_(device),
        bvh_(std::move(bvh)),
        refit_(device, *bvh_, {animation.triangles.data(), animation.triangles.size()}, method),
        positions_(device, animation, interpolate) {
    if (!interpolate) return;
    for (const double time : times) frames_.push_back(key_position(animation, time));
  }

  FrameUpdate update(const Scene& frame, std::size_t index) override {
    vulkan::Slice vertices = positions_.from_host();
    if (frames_.empty()) vulkan::upload(device_, vertices, std::span<const Vec3>(frame.vertices.data(), frame.vertices.size()));
    vulkan::Commands commands(device_);
    commands.mark("interpolate");
    if (!frames_.empty()) vertices = positions_.record(commands, frames_.at(index));
    commands.mark("refit");
    refit_.record(commands, vertices);
    const double seconds = vulkan::total_seconds(commands.finish());
    vulkan::download(device_, refit_.nodes(), std::as_writable_bytes(std::span(bvh_->nodes.data(), bvh_->nodes.size())));
    return {bvh_.get(), false, seconds};
  }
  [[nodiscard]] std::size_t bytes() const override { return bvh_->bytes() + refit_.bytes(); }

 private:
  vulkan::Device& device_;
  std::unique_ptr<Bvh2> bvh_;
  DeviceRefit refit_;
  DevicePositions positions_;
  std::vector<KeyPosition> frames_;  ///< of the frames to come; none where the host interpolates
};

class GpuRefit final : public Updater {
 public:
  static MethodInfo info() {
    return {
        .name = "gpu-refit",
        .summary = "on a Vulkan device: one tree for all frames; vertices are interpolated, then boxes recomputed",
        .citation = "Karras 2012, Sec. 4 (atomics); Lauterbach 2010, Sec. 4.1.3 (levels)",
        .params = {choice_param(
                       "tree", {"first", "best"},
                       "of the first key frame; or of the frame whose tree is cheapest over all frames (best-over-time)"),
                   choice_param("method", {"atomics", "levels"},
                                "from the leaves up in one dispatch, or a dispatch a level; the same boxes, at another speed"),
                   choice_param("interpolate", {"device", "host"},
                                "who finds the vertices between key frames; what the host finds is uploaded, untimed")},
        .accel = "bvh2",
        .on_device = true};
  }
  explicit GpuRefit(const Params& p)
      : best_(p.text("tree") == "best"),
        method_(p.text("method") == "atomics" ? DeviceRefitMethod::atomics : DeviceRefitMethod::levels),
        interpolate_(p.text("interpolate") == "device") {}

  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> times,
                                                       const TreeBuild& build, const BuildContext& context) const override {
    vulkan::Device& device = vulkan::Device::shared();
    auto tree = best_ ? updates::best_tree_over_time(animation, times, build, RefitMethod::serial, context, "gpu-refit").bvh
                      : updates::take_bvh2(build(animation), "gpu-refit");
    return std::make_unique<GpuRefitSession>(device, std::move(tree), animation, times, method_, interpolate_);
  }

 private:
  bool best_;
  DeviceRefitMethod method_;
  bool interpolate_;
};

const Registration<GpuRefit> registration;

}  // namespace
}  // namespace raystudy::gpu
