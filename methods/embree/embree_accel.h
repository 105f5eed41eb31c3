#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>

#include "harness/accel/accel.h"
#include "harness/base/shared_array.h"
#include "harness/scene/scene.h"
#include "methods/embree/embree_version.h"

namespace raystudy::embree {

/// What Embree's build takes: RTCBuildQuality and RTCSceneFlags.
struct BuildOptions {
  RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
  bool robust = false;
  bool compact = false;
  bool dynamic = false;
};

/// An Embree device: its errors are kept as text, its memory is summed up.
class Device {
 public:
  /// `threads` build a scene.
  explicit Device(int threads);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] RTCDevice handle() const { return handle_.get(); }
  [[nodiscard]] std::int64_t bytes() const { return bytes_.load(); }
  /// Builds `scene` on the device's threads.
  void commit(RTCScene scene) const;
  /// Throws Error with what Embree reported since the last call; `doing` tells what was tried.
  void check(const char* doing);

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  static void on_error(void* self, RTCError code, const char* text);
  static bool on_memory(void* self, ssize_t bytes, bool post);

  int threads_;
  bool by_tbb_ = true;
  std::mutex mutex_;
  std::string error_;
  std::atomic<std::int64_t> bytes_ = 0;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> handle_;
};

/// Embree's own structure over the scene's own arrays, which it keeps alive.
class EmbreeAccel final : public Accel {
 public:
  static constexpr std::string_view kind_name = "embree";

  EmbreeAccel(const Scene& scene, const BuildOptions& options, int threads);

  [[nodiscard]] std::string_view kind() const override { return kind_name; }
  /// What Embree allocated on the device (by its memory monitor), without a copy of the vertices where one was needed.
  [[nodiscard]] std::size_t bytes() const override { return bytes_; }
  [[nodiscard]] RTCScene handle() const { return scene_.get(); }
  [[nodiscard]] Device& device() const { return *device_; }

 private:
  struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  void attach(const Scene& scene, const BuildOptions& options);

  SharedArray<Vec3> vertices_;
  SharedArray<Triangle> triangles_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene> scene_;
  std::size_t copied_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace raystudy::embree
