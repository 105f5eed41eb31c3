#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/geometry/vec3.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// How the boxes of a tree are recomputed, children before parents. All give the same boxes bit for bit, whatever the threads.
enum class RefitMethod : std::uint8_t {
  serial,    ///< one sweep over all nodes (Lauterbach 2010, Sec. 4.1.3)
  subtrees,  ///< subtrees in parallel, several times as many as threads, then the nodes above them (ibid., Sec. 4.2.2)
  atomics    ///< from the leaves up in parallel: of two siblings the later one goes on to their parent (Karras 2012, Sec. 4)
};

/// As `method: …` names them, in the order of RefitMethod.
[[nodiscard]] std::vector<std::string> refit_method_names();
[[nodiscard]] RefitMethod refit_method(const std::string& name);

/// Recomputes the boxes of one tree for triangles that have moved. What it must know of the tree's form is found out once, and
/// the vertices of triangles are listed leaf by leaf, so that a sweep reads all but the vertices' positions in the order of
/// memory.
///
/// A leaf's box becomes that of its whole triangles. In a tree of spatial splits (Bvh2::duplicates) the boxes that clipped a
/// triangle's parts grow to the whole triangle in every leaf that it is in, which still is a tree that covers them all.
class Refitter {
 public:
  /// `triangles` are the scene's. Threads count in `refit`; serial uses one.
  Refitter(const Bvh2& bvh, std::span<const Triangle> triangles, RefitMethod method, int threads);

  /// `bvh` is the tree this was made for or a copy, with the same nodes in the same places; `vertices` are the scene's at the
  /// moment. Throws std::logic_error for a tree of another size.
  void refit(Bvh2& bvh, std::span<const Vec3> vertices);

  /// Memory held, in bytes.
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// Pairs of siblings at [begin, end) of the depth-first order.
  struct Range {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };

  void list_subtrees(const Bvh2& bvh, const std::vector<std::uint32_t>& order);
  void list_parents(const Bvh2& bvh);
  void refit_all(Bvh2& bvh, std::span<const Vec3> vertices);

  RefitMethod method_;
  int threads_;
  std::size_t node_slots_;
  std::vector<Triangle> corners_;                    ///< of Bvh2::triangles, in their order
  std::vector<std::uint32_t> order_;                 ///< pairs depth first; empty where memory has them so
  std::vector<std::uint64_t> leaves_;                ///< a bit a node, in that order (atomics: in memory's): whether it is a leaf
  std::vector<Range> subtrees_;                      ///< of RefitMethod::subtrees
  std::vector<std::uint32_t> above_subtrees_;        ///< pairs that are in none of them, parents first
  std::vector<std::uint32_t> parents_;               ///< of RefitMethod::atomics: for each pair the node that it is below
  std::vector<std::atomic<std::uint8_t>> arrivals_;  ///< of each pair of inner nodes: 1 after the first is done, 0 after both
};

}  // namespace raystudy
