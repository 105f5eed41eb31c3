#pragma once

#include <charconv>
#include <cstdlib>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "harness/scene/source.h"

namespace raystudy {

/// Walks through a text file word by word and knows line and column for messages.
class TextCursor {
 public:
  explicit TextCursor(const SourceFile& source, std::size_t offset = 0, int line = 1)
      : name_(source.name),
        p_(source.bytes.data() + offset),
        end_(source.bytes.data() + source.bytes.size()),
        line_begin_(p_),
        word_(p_),
        line_(line) {}

  [[nodiscard]] std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - p_); }
  [[nodiscard]] bool at_end() const { return p_ == end_; }

  /// The next word of the file; empty at its end.
  std::string_view next_word() {
    while (p_ != end_ && is_space(*p_)) {
      if (*p_++ == '\n') begin_line();
    }
    return take_word();
  }
  /// The next word of this line; empty at its end.
  std::string_view next_word_of_line() {
    while (p_ != end_ && is_space(*p_) && *p_ != '\n') ++p_;
    return take_word();
  }
  /// What is left of this line, without surrounding white space.
  std::string_view rest_of_line() {
    while (p_ != end_ && is_space(*p_) && *p_ != '\n') ++p_;
    word_ = p_;
    while (p_ != end_ && *p_ != '\n') ++p_;
    const char* last = p_;
    while (last != word_ && is_space(last[-1])) --last;
    return {word_, static_cast<std::size_t>(last - word_)};
  }
  /// Goes to the beginning of the next line; false at the file's end.
  bool next_line() {
    while (p_ != end_ && *p_ != '\n') ++p_;
    if (p_ == end_) return false;
    ++p_;
    begin_line();
    return p_ != end_;
  }

  /// Throws Error at the last word.
  [[noreturn]] void fail(std::string message, std::string expected = {}, std::string nearest = {}) const {
    const int column = static_cast<int>(word_ - line_begin_) + 1;
    throw Error(Diagnostic{{name_, line_, column}, std::move(message), std::move(expected), std::move(nearest)});
  }

  /// The whole word as a number. Numbers too large for T become infinite (finish_scene refuses them by name), "nan" is NaN.
  template <class T>
  [[nodiscard]] static bool parse(std::string_view word, T& value) {
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument) return false;
    if constexpr (std::is_floating_point_v<T>) {
      if (error != std::errc{}) value = static_cast<T>(std::strtod(std::string(word).c_str(), nullptr));
      return true;
    }
    return error == std::errc{};
  }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  void begin_line() {
    ++line_;
    line_begin_ = p_;
  }
  std::string_view take_word() {
    word_ = p_;
    while (p_ != end_ && !is_space(*p_)) ++p_;
    return {word_, static_cast<std::size_t>(p_ - word_)};
  }

  std::string name_;
  const char* p_;
  const char* end_;
  const char* line_begin_;
  const char* word_;  ///< where the last word began
  int line_;
};

/// A word of the file as shown in a message: cut when long, bytes outside printable ASCII as \xNN.
[[nodiscard]] std::string shown(std::string_view word);

}  // namespace raystudy
