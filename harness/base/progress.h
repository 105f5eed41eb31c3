#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

namespace raystudy {

/// How far long work has come: a bar with the time left on a terminal, plain lines elsewhere.
///
/// Plain lines are those of `line`, and, where `plain_step` is not 0, one for each such share of the whole.
class Progress {
 public:
  struct Style {
    bool terminal = false;
    double plain_step = 0;  ///< e.g. 0.1: a plain line every tenth
  };

  /// `total` in any unit; 0 where it is not known. A terminal is recognized.
  Progress(std::string title, double total, double plain_step = 0, std::FILE* stream = stderr);
  Progress(std::string title, double total, Style style, std::FILE* stream);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  ///< takes the bar away

  /// Sets what is done so far, in the unit of `total`, and what is being done now.
  void update(double done, std::string_view now = {});
  /// A line that stays, above the bar.
  void line(std::string_view text);
  /// Draws the bar again, for the time left to go on ticking while nothing is reported.
  void refresh() { draw(false); }

 private:
  void draw(bool at_once);
  void clear();
  [[nodiscard]] double share() const;

  std::string title_;
  double total_;
  Style style_;
  std::FILE* stream_;
  double done_ = 0;
  std::string now_;
  double next_plain_ = 0;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_draw_{};
};

/// `5.2 s`, `3 min 20 s`, `2 h 05 min`.
[[nodiscard]] std::string duration_text(double seconds);
/// `512 B`, `1.5 KiB`, `20 MiB`.
[[nodiscard]] std::string bytes_text(double bytes);

}  // namespace raystudy
