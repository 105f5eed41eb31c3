#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace raystudy::insertion {

/// A binary heap of integers, the least on top. Unlike std::priority_queue it keeps its memory when cleared and can replace its
/// top in one go, which is what most steps of a search do.
class MinHeap {
 public:
  [[nodiscard]] bool empty() const { return values_.empty(); }
  [[nodiscard]] std::uint64_t top() const { return values_.front(); }
  void clear() { values_.clear(); }

  void push(std::uint64_t value) {
    std::size_t i = values_.size();
    values_.push_back(value);
    while (i > 0 && value < values_[(i - 1) / 2]) {
      values_[i] = values_[(i - 1) / 2];
      i = (i - 1) / 2;
    }
    values_[i] = value;
  }

  std::uint64_t pop() {
    const std::uint64_t least = values_.front();
    const std::uint64_t last = values_.back();
    values_.pop_back();
    if (!values_.empty()) sink(last);
    return least;
  }

  /// Takes the top out and puts `value` in.
  std::uint64_t replace_top(std::uint64_t value) {
    const std::uint64_t least = values_.front();
    sink(value);
    return least;
  }

 private:
  /// Puts `value` in place of the top.
  void sink(std::uint64_t value) {
    const std::size_t count = values_.size();
    std::size_t i = 0;
    for (std::size_t child = 1; child < count; child = 2 * i + 1) {
      if (child + 1 < count && values_[child + 1] < values_[child]) ++child;
      if (value <= values_[child]) break;
      values_[i] = values_[child];
      i = child;
    }
    values_[i] = value;
  }

  std::vector<std::uint64_t> values_;
};

}  // namespace raystudy::insertion
