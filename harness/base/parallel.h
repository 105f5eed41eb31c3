#pragma once

// Threads by oneTBB. The thread sanitizer cannot see the hand-over of work inside TBB's library and would report a race on all
// that two tasks share in turn; under it the same calls run on plain threads, which it understands.
#if defined(__SANITIZE_THREAD__)
#define RAYSTUDY_PLAIN_THREADS 1
#else
#define RAYSTUDY_PLAIN_THREADS 0
#endif

#if RAYSTUDY_PLAIN_THREADS
#include <atomic>
#include <list>
#include <thread>
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#endif

#include <algorithm>
#include <cstddef>
#include <utility>

namespace raystudy {

#if RAYSTUDY_PLAIN_THREADS

/// Tasks that may run at the same time as the caller. `wait` returns when all have ended; the destructor demands it was called.
class TaskGroup {
 public:
  template <class F>
  void run(F f) {
    if (live().fetch_add(1) >= most_threads) {
      live().fetch_sub(1);
      f();
      return;
    }
    std::thread thread([f = std::move(f)]() mutable {
      f();
      live().fetch_sub(1);
    });
    while (lock_.test_and_set(std::memory_order_acquire)) {
    }
    threads_.push_back(std::move(thread));
    lock_.clear(std::memory_order_release);
  }
  void wait() {
    for (;;) {
      std::list<std::thread> threads;
      while (lock_.test_and_set(std::memory_order_acquire)) {
      }
      threads.swap(threads_);
      lock_.clear(std::memory_order_release);
      if (threads.empty()) return;
      for (std::thread& thread : threads) thread.join();
    }
  }

 private:
  static constexpr int most_threads = 4;
  static std::atomic<int>& live() {
    static std::atomic<int> count{0};
    return count;
  }
  std::atomic_flag lock_;
  std::list<std::thread> threads_;
};

template <class F>
void with_threads(int, F&& f) {
  std::forward<F>(f)();
}

template <class F>
void parallel_for_blocks(std::size_t count, std::size_t grain, const F& f) {
  const std::size_t block = std::max(grain, (count + 3) / 4);
  TaskGroup tasks;
  for (std::size_t begin = 0; begin < count; begin += block) {
    tasks.run([&f, begin, end = std::min(begin + block, count)] { f(begin, end); });
  }
  tasks.wait();
}

#else

/// Tasks that may run at the same time as the caller, on the threads of the surrounding `with_threads`. A task may give further
/// tasks to its own group. `wait` returns when all have ended and rethrows the first exception.
class TaskGroup {
 public:
  template <class F>
  void run(F f) {
    group_.run(std::move(f));
  }
  void wait() { group_.wait(); }

 private:
  tbb::task_group group_;
};

/// Calls f() so that parallel work inside it uses `threads` threads, the caller among them.
template <class F>
void with_threads(int threads, F&& f) {
  tbb::task_arena arena(threads);
  arena.execute(std::forward<F>(f));
}

/// Calls f(begin, end) for blocks that cover [0, count), each of `grain` elements or more where there are so many.
template <class F>
void parallel_for_blocks(std::size_t count, std::size_t grain, const F& f) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&f](const auto& range) { f(range.begin(), range.end()); });
}

#endif

/// Calls f(i) for each i in [0, count), each call a task of its own: for few, large pieces of work.
template <class F>
void parallel_for_each(std::size_t count, const F& f) {
  if (count == 0) return;
  TaskGroup tasks;
  for (std::size_t i = 1; i < count; ++i) tasks.run([&f, i] { f(i); });
  f(std::size_t{0});
  tasks.wait();
}

}  // namespace raystudy
