#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "harness/accel/wide_bvh.h"
#include "harness/method/method.h"
#include "methods/wide/wide_ray.h"

namespace raystudy::wide {

/// A WideBvh as its traversal sees it.
struct Tree {
  const void* nodes = nullptr;  ///< of the type that the kernel is for
  const float* corners = nullptr;
  const std::uint32_t* triangles = nullptr;
  Box bounds;
  SlabScene slabs;
  std::uint32_t height = 0;

  explicit Tree(const WideBvh& bvh);

  /// Asks for memory of a child before its turn comes: of a node the first five cache lines; of a leaf four of corners, of which
  /// most leaves have no more, and one of triangles' indices. By a table, since a branch could not be predicted; inlined, since
  /// the compiler drops calls that do nothing else.
  [[gnu::always_inline]] void prefetch(std::uint32_t child) const {
    const std::size_t kind = child >> 31U;
    const std::size_t index = WideChild::first(child);
    const char* const at = first_lines_[kind].begin + first_lines_[kind].stride * index;
    for (std::size_t line = 0; line < 4; ++line) __builtin_prefetch(at + 64 * line);
    __builtin_prefetch(last_line_[kind].begin + last_line_[kind].stride * index);
  }

 private:
  struct Array {
    const char* begin;
    std::size_t stride;
  };
  std::array<Array, 2> first_lines_;  ///< of nodes and of leaves
  std::array<Array, 2> last_line_;
};

/// Decides a triangle that the signs of the rounded edge functions did not rule out: triangle `i` of the leaf of `n` at `rows`.
/// Takes it into `hit` where it is nearer, or as near and of a lower index; true where it was.
bool finish_triangle(const float* rows, std::uint32_t n, std::uint32_t i, std::uint32_t triangle, const TriangleRay& ray,
                     float tmin, Hit& hit);

/// The traversal of one kind of node in one instruction set.
struct Kernel {
  void (*trace)(const Tree& tree, std::span<const Ray> rays, std::span<Hit> hits, Query query);
  TraceCounts (*count)(const Tree& tree, std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps);
};

/// Vector instructions. `best` is what this processor has the most lanes of.
enum class Simd : std::uint8_t { best, avx2 };

/// One ray after another, or many in turns.
enum class Schedule : std::uint8_t { one_by_one, in_turns };

/// The faster one with AVX-512, for a tree of so many bytes: coherent rays go one by one, but in a tree of 16 MiB and more even
/// they wait for memory at most leaves, unless others are worked on meanwhile.
[[nodiscard]] Schedule best_schedule(bool coherent, std::size_t bytes);
/// Which of the functions of RAYSTUDY_OF_EACH (targets.h) `simd` means here. Throws Error where the processor lacks it.
[[nodiscard]] std::size_t instruction_set(Simd simd);
/// Throws Error where the processor lacks `simd`.
[[nodiscard]] Kernel kernel_for(const WideBvh& bvh, Schedule schedule, Simd simd);
/// "AVX-512", "AVX2", "SSE4": what kernel_for(…, Simd::best) takes here.
[[nodiscard]] std::string_view best_simd();

}  // namespace raystudy::wide
