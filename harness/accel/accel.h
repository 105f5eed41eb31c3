#pragma once

#include <cstddef>
#include <string_view>

namespace raystudy {

/// Any acceleration structure. `kind` is what tracers, encoders and metrics ask for, e.g. "bvh2" or "embree".
class Accel {
 public:
  Accel() = default;
  Accel(const Accel&) = default;
  Accel& operator=(const Accel&) = default;
  Accel(Accel&&) = default;
  Accel& operator=(Accel&&) = default;
  virtual ~Accel() = default;

  [[nodiscard]] virtual std::string_view kind() const = 0;
  /// Memory the structure needs to be traced, in bytes, without the scene's own vertices and triangles.
  [[nodiscard]] virtual std::size_t bytes() const = 0;
};

}  // namespace raystudy
