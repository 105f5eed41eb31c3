#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/accel/pair_tree.h"

namespace raystudy::insertion {

/// Which reinsertions of a batch exclude each other. The first to ask for its slots gets them, for as long as the batch lasts:
/// asked in the order of gain, this is what rounds of the paper's atomic maximum over (gain, node) end with.
class Conflicts {
 public:
  /// `whole_paths`: a reinsertion takes every slot from where its node was to where it goes, whose boxes it changes, not only
  /// those that get another node. `tree` must outlive this.
  Conflicts(const PairTree& tree, bool whole_paths) : tree_(tree), whole_paths_(whole_paths), taken_(2 * tree.pairs.size(), 0) {}

  void begin_batch() { ++batch_; }

  /// Takes what moving the node at `slot` beside the one at `to` needs. False, and nothing taken, where a part is taken already,
  /// or where `to` has come to stand below the node itself.
  [[nodiscard]] bool take_node(std::uint32_t slot, std::uint32_t to) {
    const std::uint32_t up = tree_.up[slot / 2];
    slots_.assign({slot, slot ^ 1U, up, to});
    if (whole_paths_) add_path(up, to);
    return !is_within(to, slot) && take();
  }

  /// The same for both children of a node, which is not the root.
  [[nodiscard]] bool take_children(std::uint32_t inner, const std::array<std::uint32_t, 2>& to) {
    const std::uint32_t slot = tree_.up[inner];
    const std::uint32_t up = tree_.up[slot / 2];
    slots_.assign({2 * inner, 2 * inner + 1, slot, slot ^ 1U, up, to[0], to[1]});
    if (whole_paths_) {
      for (const std::uint32_t target : to) add_path(up, target);
    }
    return !is_within(to[0], slot) && !is_within(to[1], slot) && take();
  }

 private:
  /// The slots above `from` and above `to`, up to where the two paths meet.
  void add_path(std::uint32_t from, std::uint32_t to) {
    const auto list_up = [&](std::uint32_t slot, std::vector<std::uint32_t>& path) {
      path.clear();
      for (; slot >= 2; slot = tree_.up[slot / 2]) path.push_back(slot);
    };
    list_up(from, from_path_);
    list_up(to, to_path_);
    while (!from_path_.empty() && !to_path_.empty() && from_path_.back() == to_path_.back()) {
      from_path_.pop_back();
      to_path_.pop_back();
    }
    slots_.insert(slots_.end(), from_path_.begin(), from_path_.end());
    slots_.insert(slots_.end(), to_path_.begin(), to_path_.end());
  }

  [[nodiscard]] bool take() {
    for (const std::uint32_t slot : slots_) {
      if (taken_[slot] == batch_) return false;
    }
    for (const std::uint32_t slot : slots_) taken_[slot] = batch_;
    return true;
  }

  /// Whether the node at `slot` is the one at `top` or below it.
  [[nodiscard]] bool is_within(std::uint32_t slot, std::uint32_t top) const {
    while (slot != top && slot >= 2) slot = tree_.up[slot / 2];
    return slot == top;
  }

  const PairTree& tree_;
  bool whole_paths_;
  std::vector<std::uint64_t> taken_;  ///< by slot: the last batch in which a reinsertion took it
  std::uint64_t batch_ = 0;
  std::vector<std::uint32_t> slots_;
  std::vector<std::uint32_t> from_path_;
  std::vector<std::uint32_t> to_path_;
};

}  // namespace raystudy::insertion
