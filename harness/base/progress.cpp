#include "harness/base/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace raystudy {
namespace {

constexpr std::chrono::milliseconds redraw_interval{100};
constexpr int bar_width = 24;

bool is_terminal(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  return isatty(fileno(stream)) != 0 && term != nullptr && std::string_view(term) != "dumb";
}

std::size_t terminal_width(std::FILE* stream) {
  winsize size{};
  return ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// Cuts to `width` code points, never inside one.
std::string_view fitted(std::string_view text, std::size_t width) {
  std::size_t bytes = 0;
  for (std::size_t columns = 0; bytes < text.size(); ++bytes) {
    const bool begins_code_point = (static_cast<unsigned char>(text[bytes]) & 0xC0U) != 0x80U;
    if (begins_code_point && columns++ == width) break;
  }
  return text.substr(0, bytes);
}

}  // namespace

Progress::Progress(std::string title, double total, double plain_step, std::FILE* stream)
    : Progress(std::move(title), total, Style{is_terminal(stream), plain_step}, stream) {}

Progress::Progress(std::string title, double total, Style style, std::FILE* stream)
    : title_(std::move(title)), total_(total), style_(style), stream_(stream), next_plain_(style.plain_step) {
  draw(true);
}

Progress::~Progress() { clear(); }

double Progress::share() const { return total_ > 0 ? std::clamp(done_ / total_, 0.0, 1.0) : 0.0; }

void Progress::update(double done, std::string_view now) {
  done_ = done;
  now_ = now;
  if (style_.terminal) {
    draw(false);
  } else if (style_.plain_step > 0 && share() >= next_plain_) {
    fmt::print(stream_, "{}: {:.0f} %\n", title_, 100 * share());
    std::fflush(stream_);
    next_plain_ = style_.plain_step * (std::floor(share() / style_.plain_step + 1e-9) + 1);
  }
}

void Progress::line(std::string_view text) {
  clear();
  fmt::print(stream_, "{}\n", text);
  std::fflush(stream_);
  draw(true);
}

void Progress::clear() {
  if (!drawn_) return;
  fmt::print(stream_, "\r\x1b[K");
  std::fflush(stream_);
  drawn_ = false;
}

void Progress::draw(bool at_once) {
  if (!style_.terminal) return;
  const auto now = std::chrono::steady_clock::now();
  if (!at_once && drawn_ && now - last_draw_ < redraw_interval) return;
  last_draw_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const int filled = static_cast<int>(share() * bar_width);
  // Before a fiftieth is done an estimate would be a guess.
  const std::string left = share() > 0.02 ? duration_text(elapsed * (1 - share()) / share()) + " left" : std::string{};
  const std::string text = total_ > 0 ? fmt::format("{} [{:#>{}}{:.>{}}] {:3.0f} %  {}  {}", title_, "", filled, "",
                                                    bar_width - filled, 100 * share(), left, now_)
                                      : fmt::format("{}  {}  {}", title_, duration_text(elapsed), now_);
  fmt::print(stream_, "\r{}\x1b[K", fitted(text, terminal_width(stream_) - 1));
  std::fflush(stream_);
  drawn_ = true;
}

std::string duration_text(double seconds) {
  if (seconds < 60) return fmt::format("{:.{}f} s", seconds, seconds < 9.95 ? 1 : 0);
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string bytes_text(double bytes) {
  constexpr std::array units{"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (bytes >= 1024 && unit + 1 < units.size()) {
    bytes /= 1024;
    ++unit;
  }
  return fmt::format("{:.4g} {}", bytes, units.at(unit));
}

}  // namespace raystudy
