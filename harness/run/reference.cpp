#include "harness/run/reference.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/method/registry.h"

namespace raystudy {

Reference::Reference(const Scene& scene, int threads) {
  const Registry& registry = Registry::instance();
  BuildContext context;
  context.threads = threads;
  accel_ = registry.create<Builder>(registry.ref(Role::builder, "embree", {{"robust", true}}))->build(scene, context);
  tracer_ = registry.create<Tracer>(registry.ref(Role::tracer, "embree"));
  session_ = tracer_->prepare(*accel_, scene, threads, false);
}

void Reference::trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) { session_->trace(rays, hits, query); }

std::string find_wrong_hit(const Scene& scene, std::span<const Ray> rays, Query query, std::span<const Hit> reference,
                           std::span<const Hit> hits) {
  const double tolerance = 1e-4 * static_cast<double>(scene.diagonal());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& ours = hits[i];
    const Hit& theirs = reference[i];
    if (ours.is_hit() != theirs.is_hit()) {
      return fmt::format("ray {} {}, Embree {}", i, ours.is_hit() ? "hits" : "misses", theirs.is_hit() ? "hits" : "misses");
    }
    if (query == Query::any_hit || !ours.is_hit()) continue;
    const double length_of_direction = length(rays[i].direction);
    if (std::abs(static_cast<double>(ours.t) - static_cast<double>(theirs.t)) * length_of_direction > tolerance) {
      return fmt::format("ray {} meets triangle {} at t = {}, Embree triangle {} at t = {}", i, ours.triangle, ours.t,
                         theirs.triangle, theirs.t);
    }
  }
  return {};
}

}  // namespace raystudy
