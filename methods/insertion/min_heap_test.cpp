#include "methods/insertion/min_heap.h"

#include <gtest/gtest.h>

#include <queue>
#include <random>

namespace raystudy::insertion {
namespace {

TEST(MinHeap, IsAPriorityQueue) {
  std::mt19937_64 random(1);
  MinHeap heap;
  std::priority_queue<std::uint64_t, std::vector<std::uint64_t>, std::greater<>> expected;
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_EQ(heap.empty(), expected.empty());
    const std::uint64_t value = random() % 100;
    const std::uint64_t action = random() % 5;
    if (expected.empty() || action < 2) {
      heap.push(value);
      expected.push(value);
      continue;
    }
    ASSERT_EQ(heap.top(), expected.top());
    ASSERT_EQ(action == 2 ? heap.replace_top(value) : heap.pop(), expected.top());
    expected.pop();
    if (action == 2) expected.push(value);
  }
  heap.clear();
  EXPECT_TRUE(heap.empty());
}

}  // namespace
}  // namespace raystudy::insertion
