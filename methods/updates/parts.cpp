#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/updates/refit_session.h"
#include "methods/updates/split.h"

namespace raystudy::updates {
namespace {

class PartsSession final : public UpdateSession {
 public:
  /// Tree i is for the frames from begins[i] on.
  PartsSession(std::vector<RefittedTree> trees, std::vector<std::size_t> begins)
      : trees_(std::move(trees)), begins_(std::move(begins)) {}

  FrameUpdate update(const Scene& frame, std::size_t index) override {
    const auto next = std::upper_bound(begins_.begin(), begins_.end(), index);
    RefittedTree& tree = trees_[static_cast<std::size_t>(next - begins_.begin()) - 1];
    tree.refit(frame);
    return {tree.bvh.get(), false};
  }
  [[nodiscard]] std::size_t bytes() const override {
    std::size_t sum = 0;
    for (const RefittedTree& tree : trees_) sum += tree.bytes();
    return sum;
  }

 private:
  std::vector<RefittedTree> trees_;
  std::vector<std::size_t> begins_;
};

/// An animation that is to be split, at its frames' times.
class Splitting {
 public:
  Splitting(const Scene& animation, std::span<const double> times, const TreeBuild& build, RefitMethod method,
            const BuildContext& context)
      : animation_(animation), times_(times), build_(build), method_(method), context_(context) {}

  /// The tree of frames [begin, end).
  [[nodiscard]] RefittedTree tree(std::size_t begin, std::size_t end) const {
    const double from = times_[begin];
    const double to = times_[end - 1];
    const Scene part = from < to ? part_of(animation_, from, to) : scene_at(animation_, from);
    return {take_bvh2(build_(part), "parts"), part, method_, context_.threads};
  }

  /// The cost of each frame of [begin, end) with that tree.
  [[nodiscard]] std::vector<double> frame_costs(std::size_t begin, std::size_t end) const {
    RefittedTree own = tree(begin, end);
    std::vector<double> costs;
    for (std::size_t f = begin; f < end; ++f) {
      own.refitter.refit(*own.bvh, positions_at(animation_, times_[f]));
      costs.push_back(tree_cost(*own.bvh, context_.cost));
    }
    return costs;
  }

  /// The cost of the frame with a tree that is built for it alone.
  [[nodiscard]] double own_cost(std::size_t frame) const {
    return tree_cost(*take_bvh2(build_(scene_at(animation_, times_[frame])), "parts"), context_.cost);
  }

 private:
  const Scene& animation_;
  std::span<const double> times_;
  const TreeBuild& build_;
  RefitMethod method_;
  const BuildContext& context_;
};

class Parts final : public Updater {
 public:
  static MethodInfo info() {
    return {
        .name = "parts",
        .summary = "several trees, each built on a part of the animation and refitted within it",
        .citation =
            "Bittner and Meister 2015, Sec. 6.2 and Fig. 5 (Museum*: 3 equal parts); the other splits are future work there",
        .params = {choice_param("split", {"equal", "optimal", "bound"},
                                "parts of equally many frames, of the least mean cost, or the fewest that keep `max_cost`"),
                   integer_param("count", 3, "parts; as many as frames where those are fewer; not for bound", 1, 1e6),
                   integer_param("steps", 10,
                                 "equal steps of the animation between which optimal and bound look for the best borders", 1,
                                 1e4),
                   real_param("max_cost", 1.5,
                              "of bound: every frame's cost at most, as a multiple of that of a tree built for the frame alone",
                              1, 1e9),
                   refit_method_param()},
        .accel = "bvh2"};
  }
  explicit Parts(const Params& p)
      : split_(p.text("split")),
        count_(static_cast<std::size_t>(p.integer("count"))),
        steps_(static_cast<std::size_t>(p.integer("steps"))),
        max_cost_(p.real("max_cost")),
        method_(refit_method(p.text("method"))) {}

  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> times,
                                                       const TreeBuild& build, const BuildContext& context) const override {
    const Splitting splitting(animation, times, build, method_, context);
    std::vector<std::size_t> begins = split(splitting, times.size());
    std::vector<RefittedTree> trees;
    trees.reserve(begins.size());
    for (std::size_t i = 0; i < begins.size(); ++i) {
      trees.push_back(splitting.tree(begins[i], i + 1 < begins.size() ? begins[i + 1] : times.size()));
    }
    return std::make_unique<PartsSession>(std::move(trees), std::move(begins));
  }

 private:
  /// The first frames of the parts.
  [[nodiscard]] std::vector<std::size_t> split(const Splitting& splitting, std::size_t frames) const {
    if (split_ == "equal") return equal_parts(frames, std::min(count_, frames));
    std::vector<std::size_t> borders = equal_parts(frames, std::min(steps_, frames));
    borders.push_back(frames);
    std::vector<std::size_t> begins = split_ == "optimal" ? least_cost(splitting, borders) : within_bound(splitting, borders);
    for (std::size_t& begin : begins) begin = borders[begin];
    return begins;
  }

  [[nodiscard]] std::vector<std::size_t> least_cost(const Splitting& splitting, const std::vector<std::size_t>& borders) const {
    const PartCosts costs(borders.size() - 1, [&](std::size_t begin, std::size_t end) {
      const std::vector<double> frames = splitting.frame_costs(borders[begin], borders[end]);
      return std::accumulate(frames.begin(), frames.end(), 0.0);
    });
    return cheapest_split(costs, std::min(count_, costs.segments()));
  }

  [[nodiscard]] std::vector<std::size_t> within_bound(const Splitting& splitting, const std::vector<std::size_t>& borders) const {
    std::vector<double> own;
    for (std::size_t f = 0; f < borders.back(); ++f) own.push_back(splitting.own_cost(f));
    std::string worst;  // of the single steps: why there may be no split
    const PartCosts costs(borders.size() - 1, [&](std::size_t begin, std::size_t end) {
      const std::vector<double> frames = splitting.frame_costs(borders[begin], borders[end]);
      for (std::size_t i = 0; i < frames.size(); ++i) {
        const double ratio = frames[i] / own[borders[begin] + i];
        if (!(frames[i] > max_cost_ * own[borders[begin] + i])) continue;
        if (end == begin + 1 && worst.empty()) {
          worst = fmt::format(
              "frame {} costs {:.3g} times its own tree's with a tree for frames {} to {}, the shortest part that "
              "{} steps allow",
              borders[begin] + i, ratio, borders[begin], borders[end] - 1, borders.size() - 1);
        }
        return std::numeric_limits<double>::infinity();
      }
      return std::accumulate(frames.begin(), frames.end(), 0.0);
    });
    std::vector<std::size_t> begins = fewest_parts(costs);
    if (!begins.empty()) return begins;
    throw Error(Diagnostic{
        {}, fmt::format("updater 'parts': {}", worst), fmt::format("more steps, or a larger max_cost than {}", max_cost_), {}});
  }

  std::string split_;
  std::size_t count_;
  std::size_t steps_;
  double max_cost_;
  RefitMethod method_;
};

const Registration<Parts> registration;

}  // namespace
}  // namespace raystudy::updates
