#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace raystudy {

/// Whose work is being done: of all cells of a scene, of one workload, of one pipeline's build, or of one cell.
enum class Scope : std::uint32_t { scene, workload, pipeline, cell };

/// Where a worker's wall-clock time goes.
enum class Spent : std::size_t { measured, warm_up, set_up, checks };

/// What a worker is doing now, in memory that it shares with its parent: it says so without a system call between timed regions,
/// and the parent can still read it when the worker has crashed.
class Board {
 public:
  struct Stage {
    Scope scope = Scope::scene;
    std::size_t index = 0;      ///< into the plan's scenes, workloads, pipelines or cells
    double seconds_before = 0;  ///< that earlier stages of the same scope and index took
    double start = 0;           ///< now_seconds() at its start
    std::string text;           ///< e.g. "building"
  };

  /// On the system-wide monotonic clock.
  [[nodiscard]] static double now_seconds();

  // The worker writes.
  void enter(const Stage& stage);
  void add_time(Spent what, double seconds);
  void count_repetition() { repetitions_.fetch_add(1, std::memory_order_relaxed); }
  /// The reason of an end that the worker sees coming.
  void last_words(std::string_view reason);

  // The parent reads.
  [[nodiscard]] Stage stage() const;
  [[nodiscard]] double time(Spent what) const;
  [[nodiscard]] std::uint32_t repetitions() const { return repetitions_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::string last_words() const { return last_words_.data(); }

 private:
  /// A sequence lock: odd while the worker writes.
  std::atomic<std::uint32_t> sequence_{0};
  std::atomic<std::uint32_t> repetitions_{0};
  std::atomic<Scope> scope_{Scope::scene};
  std::atomic<std::size_t> index_{0};
  std::atomic<double> seconds_before_{0};
  std::atomic<double> start_{0};
  std::array<std::atomic<char>, 64> text_{};
  std::array<std::atomic<double>, 4> times_{};
  std::array<char, 256> last_words_{};
};

/// A Board in memory that stays shared across fork.
class SharedBoard {
 public:
  SharedBoard();
  SharedBoard(const SharedBoard&) = delete;
  SharedBoard& operator=(const SharedBoard&) = delete;
  ~SharedBoard();
  Board& operator*() { return *board_; }
  Board* operator->() { return board_; }

 private:
  Board* board_;
};

}  // namespace raystudy
