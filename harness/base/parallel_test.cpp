#include "harness/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace raystudy {
namespace {

TEST(Parallel, BlocksCoverTheRangeOnce) {
  std::vector<int> visits(10'007);
  with_threads(4, [&] {
    parallel_for_blocks(visits.size(), 100, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
  });
  EXPECT_EQ(visits, std::vector<int>(10'007, 1));
}

TEST(Parallel, ForEachCallsEachIndexOnce) {
  std::vector<int> visits(37);
  with_threads(2, [&] { parallel_for_each(visits.size(), [&](std::size_t i) { ++visits[i]; }); });
  EXPECT_EQ(visits, std::vector<int>(37, 1));
  parallel_for_each(0, [](std::size_t) { FAIL() << "nothing to call"; });
}

void sum_halves(const std::vector<int>& values, std::size_t begin, std::size_t end, TaskGroup& tasks, std::atomic<long>& sum) {
  while (end - begin > 100) {
    const std::size_t middle = begin + (end - begin) / 2;
    tasks.run([&values, middle, end, &tasks, &sum] { sum_halves(values, middle, end, tasks, sum); });
    end = middle;
  }
  for (std::size_t i = begin; i < end; ++i) sum += values[i];
}

TEST(Parallel, TasksMayGiveTasksToTheirGroup) {
  std::vector<int> values(5000);
  std::iota(values.begin(), values.end(), 0);
  std::atomic<long> sum = 0;
  with_threads(2, [&] {
    TaskGroup tasks;
    sum_halves(values, 0, values.size(), tasks, sum);
    tasks.wait();
  });
  EXPECT_EQ(sum, 5000L * 4999 / 2);
}

TEST(Parallel, IndicesAreCalledOnceEach) {
  std::vector<int> visits(10'007);
  with_threads(3, [&] { parallel_for_indices(visits.size(), [&](std::size_t i) { ++visits[i]; }); });
  EXPECT_EQ(visits, std::vector<int>(10'007, 1));
}

TEST(Parallel, WhatATaskThrowsReachesTheCaller) {
  const auto fail = [](std::size_t i) {
    if (i == 30) throw std::runtime_error("task 30");
  };
  EXPECT_THROW(parallel_for_each(37, fail), std::runtime_error);
  EXPECT_THROW(parallel_for_indices(37, fail), std::runtime_error);
}

}  // namespace
}  // namespace raystudy
