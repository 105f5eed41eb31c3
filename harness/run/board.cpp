#include "harness/run/board.h"

#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <new>
#include <system_error>

namespace raystudy {

static_assert(std::atomic<double>::is_always_lock_free && std::atomic<std::size_t>::is_always_lock_free,
              "a lock would not work between processes");

double Board::now_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void Board::enter(const Stage& stage) {
  sequence_.fetch_add(1, std::memory_order_acq_rel);
  scope_.store(stage.scope);
  index_.store(stage.index);
  seconds_before_.store(stage.seconds_before);
  start_.store(stage.start);
  const std::size_t length = std::min(stage.text.size(), text_.size() - 1);
  for (std::size_t i = 0; i < length; ++i) text_.at(i).store(stage.text[i], std::memory_order_relaxed);
  text_.at(length).store('\0', std::memory_order_relaxed);
  sequence_.fetch_add(1, std::memory_order_acq_rel);
}

Board::Stage Board::stage() const {
  // A worker that was killed within `enter` leaves an odd sequence; its half-written stage is then good enough.
  constexpr int attempts = 1000;
  Stage stage;
  for (int i = 0; i < attempts; ++i) {
    const std::uint32_t before = sequence_.load(std::memory_order_acquire);
    stage = {scope_.load(), index_.load(), seconds_before_.load(), start_.load(), {}};
    for (const std::atomic<char>& letter : text_) {
      const char c = letter.load(std::memory_order_relaxed);
      if (c == '\0') break;
      stage.text += c;
    }
    if (before % 2 == 0 && sequence_.load(std::memory_order_acquire) == before) break;
  }
  return stage;
}

void Board::add_time(Spent what, double seconds) {
  std::atomic<double>& time = times_.at(static_cast<std::size_t>(what));
  time.store(time.load(std::memory_order_relaxed) + seconds, std::memory_order_relaxed);
}

double Board::time(Spent what) const { return times_.at(static_cast<std::size_t>(what)).load(std::memory_order_relaxed); }

void Board::last_words(std::string_view reason) {
  const std::size_t length = std::min(reason.size(), last_words_.size() - 1);
  std::copy_n(reason.begin(), length, last_words_.begin());
  last_words_.at(length) = '\0';
}

SharedBoard::SharedBoard() {
  void* memory = mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "cannot share memory with a worker");
  board_ = new (memory) Board;
}

SharedBoard::~SharedBoard() {
  board_->~Board();
  munmap(board_, sizeof(Board));
}

}  // namespace raystudy
