#include "harness/accel/validate.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <limits>

#include "harness/accel/coverage.h"

namespace raystudy {
namespace {

class Validator {
 public:
  Validator(const Bvh2& bvh, const Scene& scene, std::size_t most)
      : bvh_(bvh),
        scene_(scene),
        most_(most),
        uses_(scene.triangles.size()),
        last_leaf_(bvh.duplicates ? scene.triangles.size() : 0, no_leaf),
        seen_(bvh.nodes.size()) {}

  std::vector<std::string> run() {
    if (bvh_.empty()) {
      if (!scene_.triangles.empty()) report("the tree is empty but the scene has {} triangles", scene_.triangles.size());
      return problems_;
    }
    if (bvh_.nodes.size() % 2 != 0) report("{} node slots, which is odd", bvh_.nodes.size());
    if (reinterpret_cast<std::uintptr_t>(bvh_.nodes.data()) % 64 != 0) report("nodes are not aligned to 64 bytes");
    visit_all();
    check_uses();
    if (bvh_.duplicates && problems_.empty()) check_coverage();
    return problems_;
  }

 private:
  static constexpr std::uint32_t no_leaf = std::numeric_limits<std::uint32_t>::max();

  template <class... Args>
  void report(fmt::format_string<Args...> format, Args&&... args) {
    if (problems_.size() < most_) problems_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }

  void visit_all() {
    std::vector<std::uint32_t> stack{0};
    seen_[0] = true;
    while (!stack.empty() && problems_.size() < most_) {
      const std::uint32_t i = stack.back();
      stack.pop_back();
      const Bvh2Node& node = bvh_.nodes[i];
      if (node.is_leaf()) {
        visit_leaf(i, node);
      } else if (visit_inner(i, node)) {
        stack.push_back(node.first);
        stack.push_back(node.first + 1);
      }
    }
  }

  bool visit_inner(std::uint32_t i, const Bvh2Node& node) {
    if (node.first < 2 || node.first % 2 != 0 || node.first + 1 >= bvh_.nodes.size()) {
      report("inner node {} has its children at {}, not an even slot in [2, {})", i, node.first, bvh_.nodes.size());
      return false;
    }
    if (seen_[node.first]) {
      report("node {} has two parents, one of them {}", node.first, i);
      return false;
    }
    seen_[node.first] = true;
    seen_[node.first + 1] = true;
    if (node.box != united(bvh_.nodes[node.first].box, bvh_.nodes[node.first + 1].box)) {
      report("the box of inner node {} is not the union of its children's", i);
    }
    return true;
  }

  void visit_leaf(std::uint32_t i, const Bvh2Node& node) {
    if (std::size_t{node.first} + node.count > bvh_.triangles.size()) {
      report("leaf {} ends at {}, past the {} triangle references", i, std::size_t{node.first} + node.count,
             bvh_.triangles.size());
      return;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const std::uint32_t t = bvh_.triangles[k];
      if (t >= scene_.triangles.size()) {
        report("leaf {} refers to triangle {} of {}", i, t, scene_.triangles.size());
        continue;
      }
      ++uses_[t];
      const Box box = scene_.triangle_box(t);
      if (!bvh_.duplicates) {
        if (!node.box.contains(box)) report("leaf {} does not contain triangle {}", i, t);
        continue;
      }
      if (last_leaf_[t] == i) report("leaf {} refers to triangle {} twice", i, t);
      last_leaf_[t] = i;
      if (!node.box.overlaps(box)) report("leaf {} does not meet triangle {}", i, t);
    }
  }

  void check_uses() {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (!seen_[i] && i != 1) report("node slot {} is not used", i);
    }
    for (std::size_t t = 0; t < uses_.size(); ++t) {
      if (uses_[t] == 0 || (uses_[t] > 1 && !bvh_.duplicates)) report("triangle {} is in {} leaves", t, uses_[t]);
    }
  }

  /// Sorts the leaves' boxes by triangle, and asks of each triangle whether they cover it.
  void check_coverage() {
    std::vector<std::size_t> ends(uses_.size());
    std::size_t sum = 0;
    for (std::size_t t = 0; t < uses_.size(); ++t) {
      ends[t] = sum;
      sum += uses_[t];
    }
    std::vector<Box> boxes(sum);
    for (std::size_t i = 0; i < bvh_.nodes.size(); ++i) {
      const Bvh2Node& node = bvh_.nodes[i];
      for (std::uint32_t k = node.first; i != 1 && k < node.first + node.count; ++k) boxes[ends[bvh_.triangles[k]]++] = node.box;
    }
    for (std::size_t t = 0; t < uses_.size(); ++t) {
      const Triangle& v = scene_.triangles[t];
      const std::span<const Box> around(boxes.data() + ends[t] - uses_[t], uses_[t]);
      if (boxes_cover(around, {scene_.vertices[v[0]], scene_.vertices[v[1]], scene_.vertices[v[2]]})) continue;
      report("triangle {} is not covered by the boxes of the {} leaves that it is in", t, uses_[t]);
    }
  }

  const Bvh2& bvh_;
  const Scene& scene_;
  std::size_t most_;
  std::vector<std::uint32_t> uses_;
  std::vector<std::uint32_t> last_leaf_;  ///< of each triangle, with duplicates
  std::vector<bool> seen_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> find_problems(const Bvh2& bvh, const Scene& scene, std::size_t most) {
  return Validator(bvh, scene, most).run();
}

}  // namespace raystudy
