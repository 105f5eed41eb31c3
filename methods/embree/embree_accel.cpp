#include "methods/embree/embree_accel.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstring>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/parallel.h"

namespace raystudy::embree {
namespace {

constexpr ssize_t tasking_by_tbb = 1;  // of RTC_DEVICE_PROPERTY_TASKING_SYSTEM

std::string_view code_name(RTCError code) {
  switch (code) {
    case RTC_ERROR_NONE: return "no error";
    case RTC_ERROR_INVALID_ARGUMENT: return "invalid argument";
    case RTC_ERROR_INVALID_OPERATION: return "invalid operation";
    case RTC_ERROR_OUT_OF_MEMORY: return "out of memory";
    case RTC_ERROR_UNSUPPORTED_CPU: return "unsupported processor";
    case RTC_ERROR_CANCELLED: return "cancelled";
    default: return "unknown error";
  }
}

RTCDevice new_device(const char* config) {
  RTCDevice device = rtcNewDevice(config);
  if (device == nullptr) throw Error(fmt::format("Embree cannot start: {}", code_name(rtcGetDeviceError(nullptr))));
  return device;
}

/// Embree reads 16 bytes from each vertex, 4 past the end of the last one. Reading is harmless where the page of the last byte
/// holds them too.
bool can_share(const SharedArray<Vec3>& vertices) {
  constexpr std::uintptr_t page = 4096;
  const auto end = reinterpret_cast<std::uintptr_t>(vertices.data() + vertices.size());
  return (end - 1) / page == (end + 3) / page;
}

}  // namespace

Device::Device(int threads) : threads_(threads), handle_(new_device("")) {
  // The device's own `threads` option would limit TBB in the whole process for good. Without TBB it is the only way.
  by_tbb_ = rtcGetDeviceProperty(handle(), RTC_DEVICE_PROPERTY_TASKING_SYSTEM) == tasking_by_tbb;
  if (!by_tbb_) {
    handle_.reset();
    handle_.reset(new_device(fmt::format("threads={}", threads).c_str()));
  }
  rtcSetDeviceErrorFunction(handle(), &Device::on_error, this);
  rtcSetDeviceMemoryMonitorFunction(handle(), &Device::on_memory, this);
}

void Device::commit(RTCScene scene) const {
  if (!by_tbb_) {
    rtcCommitScene(scene);
    return;
  }
  // Embree builds in an arena of its own, as wide as the machine, whatever arena calls it: only a limit on TBB itself holds.
  // The thread sanitizer sees neither Embree's code nor TBB's hand-over of its tasks: under it Embree builds on one thread.
  const int threads = RAYSTUDY_PLAIN_THREADS == 1 ? 1 : threads_;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  rtcCommitScene(scene);
}

void Device::on_error(void* self, RTCError code, const char* text) {
  auto& device = *static_cast<Device*>(self);
  const std::lock_guard lock(device.mutex_);
  if (!device.error_.empty()) device.error_ += "; ";
  device.error_ += fmt::format("{} ({})", text != nullptr && *text != '\0' ? text : "no details", code_name(code));
}

bool Device::on_memory(void* self, ssize_t bytes, bool) {
  static_cast<Device*>(self)->bytes_ += bytes;
  return true;
}

void Device::check(const char* doing) {
  const std::lock_guard lock(mutex_);
  if (error_.empty()) return;
  throw Error(fmt::format("Embree failed while {}: {}", doing, std::exchange(error_, {})));
}

EmbreeAccel::EmbreeAccel(const Scene& scene, const BuildOptions& options, int threads)
    : vertices_(scene.vertices), triangles_(scene.triangles), device_(std::make_unique<Device>(threads)) {
  scene_.reset(rtcNewScene(device_->handle()));
  device_->check("making a scene");
  rtcSetSceneBuildQuality(handle(), options.quality);
  int flags = RTC_SCENE_FLAG_NONE;
  if (options.robust) flags |= RTC_SCENE_FLAG_ROBUST;
  if (options.compact) flags |= RTC_SCENE_FLAG_COMPACT;
  if (options.dynamic) flags |= RTC_SCENE_FLAG_DYNAMIC;
  rtcSetSceneFlags(handle(), static_cast<RTCSceneFlags>(flags));
  if (!triangles_.empty()) attach(scene, options);
  device_->commit(handle());
  device_->check("building");
  bytes_ = static_cast<std::size_t>(device_->bytes()) - copied_;
}

void EmbreeAccel::attach(const Scene& scene, const BuildOptions& options) {
  struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
  };
  const std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry> geometry(
      rtcNewGeometry(device_->handle(), RTC_GEOMETRY_TYPE_TRIANGLE));
  device_->check("making a geometry");
  rtcSetGeometryBuildQuality(geometry.get(), options.quality);
  if (can_share(vertices_)) {
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0, sizeof(Vec3),
                               vertices_.size());
  } else {
    void* copy =
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), vertices_.size());
    device_->check("copying vertices");
    copied_ = vertices_.size() * sizeof(Vec3);
    std::memcpy(copy, vertices_.data(), copied_);
  }
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene.triangles.data(), 0,
                             sizeof(Triangle), triangles_.size());
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(handle(), geometry.get());
  device_->check("attaching triangles");
}

}  // namespace raystudy::embree
