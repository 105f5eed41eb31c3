#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"

namespace raystudy {

/// A key and what it belongs to.
template <class Key>
struct Keyed {
  Key key;
  std::uint32_t index;
};

/// A least-significant-digit radix sort with digits of up to 11 bits. Threads count and move fixed parts of the items, each to
/// places of its own, so that the order is the same however many they are.
template <class Key>
class RadixSort {
 public:
  using Item = Keyed<Key>;

  RadixSort(std::size_t n, int key_bits, int threads)
      : n_(n),
        passes_(static_cast<std::size_t>((key_bits + most_digit_bits - 1) / most_digit_bits)),
        digit_bits_((key_bits + static_cast<int>(passes_) - 1) / static_cast<int>(passes_)),
        parts_(std::clamp<std::size_t>(n / least_part, 1, static_cast<std::size_t>(threads))),
        starts_((parts_ == 1 ? passes_ : parts_) << static_cast<unsigned>(digit_bits_)) {}

  /// `items` and `other` have room for n each.
  template <class Items, class Write>
  void run(Items items, Items other, const Write& write) {
    if (parts_ == 1) count_all(&items[0]);
    for (std::size_t pass = 0; pass + 1 < passes_; ++pass) {
      move(&items[0], pass, [to = &other[0]](std::size_t place, const Item& item) { to[place] = item; });
      std::swap(items, other);
    }
    other = Items();
    move(&items[0], passes_ - 1, write);
  }

 private:
  static constexpr int most_digit_bits = 11;
  static constexpr std::size_t least_part = 8192;

  [[nodiscard]] std::size_t digits() const { return std::size_t{1} << static_cast<unsigned>(digit_bits_); }
  [[nodiscard]] std::size_t digit(Key key, std::size_t pass) const {
    return static_cast<std::size_t>(key >> (pass * static_cast<std::size_t>(digit_bits_))) & (digits() - 1);
  }

  /// Of a single part, the digits of every pass in one go.
  void count_all(const Item* items) {
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t pass = 0; pass < passes_; ++pass) ++starts_[pass * digits() + digit(items[i].key, pass)];
    }
  }

  template <class Write>
  void move(const Item* items, std::size_t pass, const Write& write) {
    const auto for_each_part = [&](const auto& f) {
      parallel_for_each(parts_, [&](std::size_t part) {
        std::uint32_t* const starts = starts_.data() + (parts_ == 1 ? pass : part) * digits();
        f(starts, items + n_ * part / parts_, items + n_ * (part + 1) / parts_);
      });
    };
    if (parts_ > 1) {
      for_each_part([&](std::uint32_t* counts, const Item* begin, const Item* end) {
        std::fill_n(counts, digits(), 0U);
        for (const Item* item = begin; item != end; ++item) ++counts[digit(item->key, pass)];
      });
    }
    std::uint32_t sum = 0;
    for (std::size_t d = 0; d < digits(); ++d) {
      for (std::size_t part = 0; part < parts_; ++part) {
        std::uint32_t& start = starts_[(parts_ == 1 ? pass : part) * digits() + d];
        start = std::exchange(sum, sum + start);
      }
    }
    for_each_part([&](std::uint32_t* starts, const Item* begin, const Item* end) {
      for (const Item* item = begin; item != end; ++item) write(starts[digit(item->key, pass)]++, *item);
    });
  }

  std::size_t n_;
  std::size_t passes_;
  int digit_bits_;
  std::size_t parts_;
  std::vector<std::uint32_t> starts_;  ///< by digit: of each pass, or with several parts of each part in the pass at work
};

/// Sorts n items by their keys, of which only the lowest `key_bits` bits may be set; equal keys stay in the order they come in.
/// write(place, item) is called once for every item, instead of a last pass: what is not needed is never stored. With `threads` >
/// 1 it is called from several threads, those of the calling thread's arena. `other` is scratch of the same size. What owns its
/// memory is freed as soon as it is not needed.
template <class Key, class Write>
void radix_sort(std::unique_ptr<Keyed<Key>[]> items, std::unique_ptr<Keyed<Key>[]> other, std::size_t n, int key_bits,
                int threads, const Write& write) {
  RadixSort<Key>(n, key_bits, threads).run(std::move(items), std::move(other), write);
}
template <class Key, class Write>
void radix_sort(Keyed<Key>* items, Keyed<Key>* other, std::size_t n, int key_bits, int threads, const Write& write) {
  RadixSort<Key>(n, key_bits, threads).run(items, other, write);
}

}  // namespace raystudy
