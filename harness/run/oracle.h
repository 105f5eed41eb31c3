#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "harness/accel/accel.h"
#include "harness/method/method.h"
#include "harness/run/exact_oracle.h"

namespace raystudy {

/// A hit that is wrong, and what exact arithmetic finds for its ray.
struct WrongHit {
  std::size_t ray = 0;
  Hit found;
  Hit reference;
  ExactHit exact;
};

struct OracleReport {
  std::size_t rays = 0;
  std::size_t disputed = 0;  ///< where tracer and reference differ by more than rounding: all decided by exact arithmetic
  std::size_t sampled = 0;   ///< checked by exact arithmetic although they agree
  std::size_t leaks = 0;     ///< rays that slipped between triangles, where the tracer is not bound to be watertight; not wrong
  std::size_t wrong = 0;     ///< counting stops at 8
  std::vector<WrongHit> examples;

  [[nodiscard]] bool ok() const { return wrong == 0; }
  /// What is wrong, for a failed cell: the number of wrong hits and the first of them, ray and both hits in full. Empty where ok.
  [[nodiscard]] std::string text(std::span<const Ray> rays, Query query) const;
};

/// Checks hits over whole buffers against a reference tracer's, and by CGAL's exact kernel on a sample and wherever the two
/// differ: the exact kernel decides, so a reference that is wrong itself fails nobody else (exact_oracle.h says what right
/// means). It remembers its verdicts: many structures over one scene give one answer for a ray. One thread at a time.
class Oracle {
 public:
  /// The scene must outlive it.
  explicit Oracle(const Scene& scene) : exact_(scene) {}

  /// `samples` rays, spread evenly over the buffer, are checked exactly even where hits agree. A hit lost between triangles is
  /// wrong for a `watertight` tracer (TraceSession::watertight) and counted as a leak for another.
  [[nodiscard]] OracleReport check(std::span<const Ray> rays, std::span<const Hit> hits, std::span<const Hit> reference,
                                   Query query, bool watertight = true, std::size_t samples = 64);

 private:
  [[nodiscard]] bool agree(const Ray& ray, const Hit& hit, const Hit& reference, Query query) const;
  [[nodiscard]] const ExactOracle::Verdict& judge(const Ray& ray, const Hit& hit, const Hit& reference, Query query);
  ExactOracle exact_;
  std::unordered_map<std::string, ExactOracle::Verdict> verdicts_;  ///< by the bytes of what was asked
};

/// Oracle(scene).check(...), for a single buffer.
[[nodiscard]] OracleReport check_hits(const Scene& scene, std::span<const Ray> rays, std::span<const Hit> hits,
                                      std::span<const Hit> reference, Query query, bool watertight = true,
                                      std::size_t samples = 64);

/// Embree, robust, single rays: what whole buffers are compared with. Made from the registry, as the harness
/// does not link Embree. The scene must outlive it.
class ReferenceTracer {
 public:
  ReferenceTracer(const Scene& scene, int threads);
  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) { session_->trace(rays, hits, query); }

 private:
  std::unique_ptr<Accel> accel_;
  std::unique_ptr<TraceSession> session_;
};

}  // namespace raystudy
