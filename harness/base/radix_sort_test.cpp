#include "harness/base/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

namespace raystudy {
namespace {

template <class Key>
std::vector<Keyed<Key>> sorted(const std::vector<Key>& keys, int bits, int threads) {
  auto items = std::make_unique_for_overwrite<Keyed<Key>[]>(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) items[i] = {keys[i], static_cast<std::uint32_t>(i)};
  std::vector<Keyed<Key>> out(keys.size());
  with_threads(threads, [&] {
    radix_sort(std::move(items), std::make_unique_for_overwrite<Keyed<Key>[]>(keys.size()), keys.size(), bits, threads,
               [&out](std::size_t place, const Keyed<Key>& item) { out[place] = item; });
  });
  return out;
}

template <class Key>
void expect_as_stable_sort(std::vector<Key> keys, int bits) {
  for (Key& key : keys) key &= static_cast<Key>(~std::uint64_t{0} >> (64U - static_cast<unsigned>(bits)));
  std::vector<Keyed<Key>> expected;
  for (const Key key : keys) expected.push_back({key, static_cast<std::uint32_t>(expected.size())});
  std::stable_sort(expected.begin(), expected.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  for (const int threads : {1, 2, 5}) {
    const auto found = sorted(keys, bits, threads);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      ASSERT_EQ(found[i].index, expected[i].index) << keys.size() << " keys of " << bits << " bits, " << threads << " threads";
      ASSERT_EQ(found[i].key, expected[i].key);
    }
  }
}

TEST(RadixSort, EqualsAStableSort) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {0, 1, 2, 1000, 60000}) {
    for (const int bits : {1, 11, 12, 30, 60, 63, 64}) {
      std::vector<std::uint64_t> keys(n);
      for (auto& key : keys) key = random();
      expect_as_stable_sort(keys, bits);
    }
    std::vector<std::uint32_t> keys(n);
    for (auto& key : keys) key = static_cast<std::uint32_t>(random());
    expect_as_stable_sort(keys, 30);
    expect_as_stable_sort(keys, 32);
  }
}

TEST(RadixSort, KeepsTheOrderOfEqualKeys) {
  std::mt19937_64 random(2);
  std::vector<std::uint32_t> keys(50000);
  for (auto& key : keys) key = static_cast<std::uint32_t>(random() % 7) << 20U;
  expect_as_stable_sort(keys, 32);
  expect_as_stable_sort(std::vector<std::uint64_t>(50000, 5), 63);
}

}  // namespace
}  // namespace raystudy
