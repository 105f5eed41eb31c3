#include <limits>
#include <utility>

#include "harness/method/registry.h"
#include "methods/spatial/presplit_records.h"
#include "methods/topdown/binned_split.h"

namespace raystudy {
namespace {

std::vector<ParamSpec> presplit_params() {
  std::vector<ParamSpec> specs = topdown::binned_params();
  specs.push_back(real_param("budget", 0.3, "parts more than triangles, at most, as a share of the triangles", 0, 16));
  return specs;
}

/// Leaves of more than one part may hold several of a triangle: it stays once.
void drop_repeats(Bvh2& bvh, std::size_t scene_triangles) {
  std::vector<std::uint32_t> last_leaf(scene_triangles, std::numeric_limits<std::uint32_t>::max());
  std::uint32_t next = 0;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    Bvh2Node& node = bvh.nodes[i];
    if (!node.is_leaf()) {
      stack.push_back(node.first + 1);
      stack.push_back(node.first);
      continue;
    }
    const std::uint32_t first = next;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const std::uint32_t triangle = bvh.triangles[k];
      if (std::exchange(last_leaf[triangle], i) != i) bvh.triangles[next++] = triangle;
    }
    node.first = first;
    node.count = next - first;
  }
  bvh.triangles.resize(next);
}

/// Splits triangles by priority, then builds over their parts as binned-sah does over triangles.
class Presplit final : public Builder {
 public:
  explicit Presplit(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {.name = "presplit",
            .summary = "binned-sah over parts of triangles, which are split beforehand where their boxes hold most empty space",
            .citation = "Karras and Aila 2013, triangle splitting",
            .params = presplit_params(),
            .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const auto measure = Registry::instance().create<Heuristic>(params_.method("heuristic"))->prepare(scene, context);
    const topdown::LeafPolicy leaves(params_, context.cost);
    const topdown::BinnedSplitter splitter(*measure, static_cast<std::uint32_t>(params_.integer("bins")), context.threads);
    auto bvh = std::make_unique<Bvh2>();
    if (scene.triangles.empty()) return bvh;
    with_threads(context.threads, [&] {
      spatial::PresplitRecords parts(scene, params_.real("budget"), context.threads);
      const auto records = parts.records();
      bvh->duplicates = records.size() > scene.triangles.size();
      bvh->nodes.resize(2 * records.size());
      bvh->triangles.resize(records.size());
      topdown::RecordBuild(splitter, leaves, *measure, records, *bvh, context.threads).run();
    });
    if (leaves.sah && bvh->duplicates) drop_repeats(*bvh, scene.triangles.size());
    return bvh;
  }

 private:
  Params params_;
};

const Registration<Presplit> registration;

}  // namespace
}  // namespace raystudy
