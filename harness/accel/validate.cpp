#include "harness/accel/validate.h"

#include <cstdint>

#include "harness/accel/tree_check.h"
#include "harness/accel/validate_wide.h"

namespace raystudy {
namespace {

class Validator {
 public:
  Validator(const Bvh2& bvh, std::size_t triangles, const Scene* scene, std::size_t most)
      : bvh_(bvh), check_(triangles, scene, bvh.duplicates, most), seen_(bvh.nodes.size()) {}

  std::vector<std::string> run() {
    if (bvh_.empty()) {
      check_.require_empty_scene();
      return check_.take_problems();
    }
    if (bvh_.nodes.size() % 2 != 0) check_.report("{} node slots, which is odd", bvh_.nodes.size());
    if (reinterpret_cast<std::uintptr_t>(bvh_.nodes.data()) % 64 != 0) check_.report("nodes are not aligned to 64 bytes");
    visit_all();
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      if (!seen_[i] && i != 1) check_.report("node slot {} is not used", i);
    }
    check_.finish_leaves();
    return check_.take_problems();
  }

 private:
  void visit_all() {
    std::vector<std::uint32_t> stack{0};
    seen_[0] = true;
    while (!stack.empty() && !check_.is_full()) {
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
    if (node.first < 2 || node.first % 2 != 0 || std::size_t{node.first} + 1 >= bvh_.nodes.size()) {
      check_.report("inner node {} has its children at {}, not an even slot in [2, {})", i, node.first, bvh_.nodes.size());
      return false;
    }
    if (seen_[node.first]) {
      check_.report("node {} has two parents, one of them {}", node.first, i);
      return false;
    }
    seen_[node.first] = true;
    seen_[node.first + 1] = true;
    if (node.box != united(bvh_.nodes[node.first].box, bvh_.nodes[node.first + 1].box)) {
      check_.report("the box of inner node {} is not the union of its children's", i);
    }
    return true;
  }

  void visit_leaf(std::uint32_t i, const Bvh2Node& node) {
    if (std::size_t{node.first} + node.count > bvh_.triangles.size()) {
      check_.report("leaf {} ends at {}, past the {} triangle references", i, std::size_t{node.first} + node.count,
                    bvh_.triangles.size());
      return;
    }
    references_ += node.count;
    if (references_ > bvh_.triangles.size()) {
      check_.report("leaf {} shares some of the {} triangle references with others", i, bvh_.triangles.size());
      return;
    }
    check_.add_leaf([i] { return fmt::format("leaf {}", i); }, node.box, {bvh_.triangles.data() + node.first, node.count});
  }

  const Bvh2& bvh_;
  TreeCheck check_;
  std::size_t references_ = 0;  ///< of the leaves so far
  std::vector<bool> seen_;
};

std::vector<std::string> problems_of(const Accel& accel, std::size_t triangles, const Scene* scene, std::size_t most) {
  if (const auto* bvh = dynamic_cast<const Bvh2*>(&accel)) return Validator(*bvh, triangles, scene, most).run();
  if (const auto* wide = dynamic_cast<const WideBvh*>(&accel)) return wide_problems(*wide, triangles, scene, most);
  return {};
}

}  // namespace

std::vector<std::string> find_problems(const Bvh2& bvh, const Scene& scene, std::size_t most) {
  return problems_of(bvh, scene.triangles.size(), &scene, most);
}

std::vector<std::string> find_problems(const WideBvh& bvh, const Scene& scene, std::size_t most) {
  return problems_of(bvh, scene.triangles.size(), &scene, most);
}

std::vector<std::string> find_problems(const Accel& accel, const Scene& scene, std::size_t most) {
  return problems_of(accel, scene.triangles.size(), &scene, most);
}

std::vector<std::string> find_structural_problems(const Accel& accel, std::size_t scene_triangles, std::size_t most) {
  return problems_of(accel, scene_triangles, nullptr, most);
}

}  // namespace raystudy
