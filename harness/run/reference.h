#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "harness/method/method.h"

namespace raystudy {

/// A method's result is wrong: reported as it is, without "error while".
class WrongResult : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Embree with robust traversal: what every tracer's hits are held against, and what gives workloads their first hits.
class Reference {
 public:
  Reference(const Scene& scene, int threads);
  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query);

 private:
  std::unique_ptr<Accel> accel_;
  std::unique_ptr<Tracer> tracer_;
  std::unique_ptr<TraceSession> session_;
};

/// The first hit that is wrong, in words; empty where all are right.
[[nodiscard]] std::string find_wrong_hit(const Scene& scene, std::span<const Ray> rays, Query query,
                                         std::span<const Hit> reference, std::span<const Hit> hits);

}  // namespace raystudy
