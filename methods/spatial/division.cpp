#include "methods/spatial/division.h"

#include <utility>

#include "harness/base/parallel.h"

namespace raystudy::spatial {

void Division::classify(std::span<const BoxRecord> records, Block& block) const {
  block.records = records;
  block.counts = {};
  block.crossings.clear();
  for (std::size_t i = 0; i < records.size(); ++i) {
    const bool begins_left = records[i].lower[axis_] < at_;
    if (begins_left && -records[i].negated_upper[axis_] > at_) {
      block.crossings.push_back({i, {true, true}, chopped(scene_, records[i], axis_, at_)});
    } else {
      ++block.counts[begins_left ? 0 : 1];
    }
  }
}

void Division::unsplit(SpatialSplit& sides, const WideBox& whole, Crossing& crossing) const {
  const std::array<WideBox, 2> grown{united(sides.boxes[0], whole), united(sides.boxes[1], whole)};
  const auto m = measure_(sides.boxes[0], sides.boxes[1], grown[0], grown[1]);
  const std::array<float, 2> n{static_cast<float>(sides.counts[0]), static_cast<float>(sides.counts[1])};
  // Where the other side would be left with nothing, there would be no split.
  const float split = m[0] * n[0] + m[1] * n[1];
  const float left = sides.counts[1] > 1 ? m[2] * n[0] + m[1] * (n[1] - 1) : split;
  const float right = sides.counts[0] > 1 ? m[0] * (n[0] - 1) + m[3] * n[1] : split;
  if (!(left < split || right < split)) return;
  const std::size_t side = left <= right ? 0 : 1;
  sides.boxes[side] = grown[side];
  --sides.counts[1 - side];
  crossing.goes[1 - side] = false;
  crossing.boxes[side] = whole;
}

std::array<std::uint32_t, 2> Division::decide(std::span<const BoxRecord> records, const SpatialSplit& split) {
  axis_ = split.axis;
  at_ = split.at;
  if (threads_ > 1 && records.size() >= topdown::shared_pass) {
    blocks_ = topdown::pass_in_blocks(records, threads_, [&](std::span<const BoxRecord> part, std::size_t) {
      Block block;
      classify(part, block);
      return block;
    });
  } else {
    blocks_.resize(1);
    classify(records, blocks_.front());
  }
  SpatialSplit sides = split;
  std::array<std::uint32_t, 2> counts{};
  for (Block& block : blocks_) {
    for (Crossing& crossing : block.crossings) {
      const WideBox whole = WideBox::of(block.records[crossing.at]);
      if (crossing.boxes[0].is_empty() || crossing.boxes[1].is_empty()) {
        // Nothing of the triangle is on one side, although its box reaches there.
        const std::size_t side = crossing.boxes[0].is_empty() ? 1 : 0;
        crossing.goes[1 - side] = false;
        if (crossing.boxes[side].is_empty()) crossing.boxes[side] = whole;
        if (sides.counts[1 - side] > 1) --sides.counts[1 - side];
      } else if (unsplitting_) {
        unsplit(sides, whole, crossing);
      }
      for (std::size_t side = 0; side < 2; ++side) block.counts[side] += crossing.goes[side] ? 1 : 0;
    }
    for (std::size_t side = 0; side < 2; ++side) counts[side] += block.counts[side];
  }
  return counts;
}

void Division::divide(const Block& block, BoxRecord* left, BoxRecord* right) const {
  const std::array<BoxRecord*, 2> to{left, right};
  std::array<std::size_t, 2> next{};
  const auto copy = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Without a branch, since which way a triangle goes cannot be predicted.
      const std::size_t side = block.records[i].lower[axis_] < at_ ? 0 : 1;
      WideBox::of(block.records[i]).store(to[side][next[side]]);
      ++next[side];
    }
  };
  std::size_t begin = 0;
  for (const Crossing& crossing : block.crossings) {
    copy(begin, crossing.at);
    for (std::size_t side = 0; side < 2; ++side) {
      if (!crossing.goes[side]) continue;
      BoxRecord& record = to[side][next[side]++];
      crossing.boxes[side].store(record);
      record.triangle = block.records[crossing.at].triangle;
      record.rank = 0;
    }
    begin = crossing.at + 1;
  }
  copy(begin, block.records.size());
}

void Division::divide(BoxRecord* left, BoxRecord* right) const {
  if (blocks_.size() == 1) return divide(blocks_.front(), left, right);
  TaskGroup tasks;
  for (const Block& block : blocks_) {
    tasks.run([this, &block, left, right] { divide(block, left, right); });
    left += block.counts[0];
    right += block.counts[1];
  }
  tasks.wait();
}

}  // namespace raystudy::spatial
