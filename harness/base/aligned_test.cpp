#include "harness/base/aligned.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <string>

namespace raystudy {
namespace {

/// The flags of the mapping that holds p, as /proc/self/smaps shows them; "" where the system does not tell.
std::string flags_at(const void* p) {
  std::ifstream maps("/proc/self/smaps");
  const auto address = reinterpret_cast<std::uintptr_t>(p);
  bool here = false;
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t from = 0;
    std::uintptr_t to = 0;
    if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " ", &from, &to) == 2) {
      here = from <= address && address < to;
    } else if (here && line.starts_with("VmFlags:")) {
      return line + " ";
    }
  }
  return "";
}

TEST(AlignedAllocator, AdvisesThePagesThatAreAskedFor) {
  const std::size_t n = 16U << 20U;
  const AlignedVector<char> huge(n);
  if (flags_at(huge.data()).find(" hg ") == std::string::npos) GTEST_SKIP() << "this system has no huge pages, or does not tell";
  const AlignedVector<char> normal(n, AlignedAllocator<char>(Pages::normal));
  EXPECT_NE(flags_at(normal.data() + n / 2).find(" nh "), std::string::npos);
  EXPECT_EQ(flags_at(normal.data() + n / 2).find(" hg "), std::string::npos);
  const AlignedVector<char> copy = normal;
  EXPECT_NE(flags_at(copy.data() + n / 2).find(" nh "), std::string::npos);
}

TEST(AlignedAllocator, LeavesElementsAloneWhereAsked) {
  int x = 7;
  AlignedAllocator<int>::uninitialized().construct(&x);
  EXPECT_EQ(x, 7);
  AlignedAllocator<int>().construct(&x);
  EXPECT_EQ(x, 0);
  // Only the vector made so: one that takes it over initializes what it adds.
  AlignedVector<int> vector;
  vector = AlignedVector<int>(2, AlignedAllocator<int>::uninitialized());
  const int* const data = vector.data();
  std::fill(vector.begin(), vector.end(), 5);
  vector.resize(1);
  vector.resize(2);
  EXPECT_EQ(vector.data(), data);
  EXPECT_EQ(vector[1], 0);
}

TEST(AlignedAllocator, BlocksBeginOnCacheLinesAndLargeOnesOnHugePages) {
  for (const Pages pages : {Pages::huge, Pages::normal}) {
    const AlignedVector<char> small(100, 1, AlignedAllocator<char>(pages));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(small.data()) % 64, 0U);
    const AlignedVector<char> large(5U << 20U, 1, AlignedAllocator<char>(pages));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(large.data()) % (2U << 20U), 0U);
    EXPECT_EQ(large.back(), 1);
  }
}

}  // namespace
}  // namespace raystudy
