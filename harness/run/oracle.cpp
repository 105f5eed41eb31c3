#include "harness/run/oracle.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "harness/method/registry.h"

namespace raystudy {
namespace {

constexpr std::size_t most_wrong = 8;

std::string hit_text(const Hit& hit, Query query) {
  if (!hit.is_hit()) return "nothing";
  if (query == Query::any_hit) return "a hit";
  return fmt::format("triangle {} at t = {:.9g} (u = {:.9g}, v = {:.9g})", hit.triangle, hit.t, hit.u, hit.v);
}

std::string exact_text(const ExactHit& hit) {
  return hit.triangle == no_hit ? "nothing" : fmt::format("triangle {} at t = {:.9g}", hit.triangle, hit.t);
}

}  // namespace

std::string OracleReport::text(std::span<const Ray> ray_buffer, Query query) const {
  if (ok()) return {};
  std::string text =
      fmt::format("wrong hits: {}{} of {} {} rays", wrong, wrong == most_wrong ? " or more" : "", rays, query_name(query));
  for (const WrongHit& example : examples) {
    const Ray& r = ray_buffer[example.ray];
    text += fmt::format(
        "\n  ray {} from ({:.9g}, {:.9g}, {:.9g}) along ({:.9g}, {:.9g}, {:.9g}), t in [{:.9g}, {:.9g}]: found {}, the reference "
        "{}, "
        "exact arithmetic {}",
        example.ray, r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z, r.tmin, r.tmax,
        hit_text(example.found, query), hit_text(example.reference, query), exact_text(example.exact));
  }
  return text;
}

bool Oracle::agree(const Ray& ray, const Hit& hit, const Hit& reference, Query query) const {
  if (hit.is_hit() != reference.is_hit()) return false;
  if (!hit.is_hit() || query == Query::any_hit) return true;
  if (hit.t == reference.t && hit.triangle == reference.triangle) return true;
  // Each of the two is off by at most 2 δ along the ray, unless it meets the triangle at a small angle.
  const double delta = exact_.tolerance(ray, hit.triangle, reference.triangle);
  const double apart = std::fabs(double{hit.t} - double{reference.t}) * double{length(ray.direction)};
  if (apart <= 4 * delta) return true;
  return hit.triangle == reference.triangle && exact_.is_on_triangle(ray, hit, 2 * delta);
}

const ExactOracle::Verdict& Oracle::judge(const Ray& ray, const Hit& hit, const Hit& reference, Query query) {
  Hit found = hit;
  Hit other = reference;
  if (query == Query::any_hit) {
    // All hits are one answer, but for those of a triangle that the scene has not.
    found = {.triangle = hit.triangle < exact_.triangle_count() ? 0 : hit.triangle};
    other = {};
  }
  std::string asked(1, static_cast<char>(query));
  const auto append = [&](const auto& value) { asked.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  append(ray);
  append(found);
  append(other);
  const auto known = verdicts_.find(asked);
  if (known != verdicts_.end()) return known->second;
  return verdicts_.emplace(std::move(asked), exact_.judge(ray, found, query, other)).first->second;
}

OracleReport Oracle::check(std::span<const Ray> rays, std::span<const Hit> hits, std::span<const Hit> reference, Query query,
                           bool watertight, std::size_t samples) {
  if (hits.size() != rays.size() || reference.size() != rays.size()) {
    throw std::logic_error("as many hits and reference hits as rays are needed");
  }
  OracleReport report;
  report.rays = rays.size();
  const auto decide = [&](std::size_t i) {
    const ExactOracle::Verdict& verdict = judge(rays[i], hits[i], reference[i], query);
    if (verdict.judgement == ExactOracle::Judgement::right) return;
    if (verdict.judgement == ExactOracle::Judgement::leak && !watertight) {
      ++report.leaks;
      return;
    }
    ++report.wrong;
    report.examples.push_back({i, hits[i], reference[i], verdict.exact});
  };
  const std::size_t stride = samples == 0 ? rays.size() + 1 : std::max<std::size_t>(1, rays.size() / samples);
  for (std::size_t i = 0; i < rays.size() && report.wrong < most_wrong; ++i) {
    if (!agree(rays[i], hits[i], reference[i], query)) {
      ++report.disputed;
      decide(i);
    } else if (i % stride == stride / 2) {
      ++report.sampled;
      decide(i);
    }
  }
  return report;
}

OracleReport check_hits(const Scene& scene, std::span<const Ray> rays, std::span<const Hit> hits, std::span<const Hit> reference,
                        Query query, bool watertight, std::size_t samples) {
  return Oracle(scene).check(rays, hits, reference, query, watertight, samples);
}

ReferenceTracer::ReferenceTracer(const Scene& scene, int threads) {
  const Registry& registry = Registry::instance();
  BuildContext context;
  context.threads = threads;
  accel_ = registry.create<Builder>(registry.ref(Role::builder, "embree", {{"robust", true}}))->build(scene, context);
  session_ = registry.create<Tracer>(registry.ref(Role::tracer, "embree"))->prepare(*accel_, scene, threads, false);
}

}  // namespace raystudy
