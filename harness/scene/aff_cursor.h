#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "harness/scene/text_cursor.h"

namespace raystudy {

/// Words of one AFF file, without comments.
class AffCursor {
 public:
  explicit AffCursor(const SourceFile& source) : cursor_(source) {}

  std::string_view next() {
    std::string_view w = cursor_.next_word();
    while (w.starts_with('#') || w.starts_with('%')) {
      (void)cursor_.rest_of_line();
      w = cursor_.next_word();
    }
    return w;
  }
  std::string_view word(std::string_view of) {
    const std::string_view w = next();
    if (w.empty()) fail(fmt::format("the file ends where {} should stand", of), "a complete file");
    return w;
  }
  double number(std::string_view of) {
    double value = 0;
    const std::string_view w = word(of);
    const bool good = TextCursor::parse(w, value);
    if (!good || !std::isfinite(value)) {
      fail(fmt::format("'{}' stands where {} should", shown(w), of), good ? "a finite number" : "a number");
    }
    return value;
  }
  std::size_t count(std::string_view of) {
    std::size_t n = 0;
    const std::string_view w = word(fmt::format("the number of {}", of));
    if (!TextCursor::parse(w, n)) fail(fmt::format("'{}' stands where the number of {} should", shown(w), of), "a whole number");
    // Every one takes two bytes at least.
    if (n > cursor_.bytes_left()) fail(fmt::format("{} {} do not fit into the file", n, of), "a complete file");
    return n;
  }
  template <std::size_t N>
  std::array<double, N> numbers(std::string_view of) {
    std::array<double, N> all{};
    for (double& k : all) k = number(of);
    return all;
  }
  Vec3 point() {
    const auto [x, y, z] = numbers<3>("a coordinate");
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  }
  void skip(std::size_t numbers, std::string_view of) {
    for (std::size_t i = 0; i < numbers; ++i) (void)number(of);
  }
  void open_brace(std::string_view of) {
    if (const std::string_view w = word("'{'"); w != "{") fail(fmt::format("'{}' follows {}", shown(w), of), "'{'");
  }
  [[noreturn]] void fail(std::string message, std::string expected = {}, std::string nearest = {}) const {
    cursor_.fail(std::move(message), std::move(expected), std::move(nearest));
  }

 private:
  TextCursor cursor_;
};

}  // namespace raystudy
