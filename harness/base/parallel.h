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
#include <exception>
#include <list>
#include <mutex>
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

class TaskGroup {
 public:
  TaskGroup() = default;
  TaskGroup(const TaskGroup&) = delete;
  TaskGroup& operator=(const TaskGroup&) = delete;
  ~TaskGroup() { join(); }
  template <class F>
  void run(F f) {
    if (live().fetch_add(1) >= most_threads) {
      live().fetch_sub(1);
      guarded(f);
      return;
    }
    std::thread thread([this, f = std::move(f)]() mutable {
      guarded(f);
      live().fetch_sub(1);
    });
    const std::lock_guard lock(mutex_);
    threads_.push_back(std::move(thread));
  }
  void wait() {
    join();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  static constexpr int most_threads = 4;
  static std::atomic<int>& live() {
    static std::atomic<int> count{0};
    return count;
  }
  template <class F>
  void guarded(F& f) {
    try {
      f();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }
  void join() {
    for (;;) {
      std::list<std::thread> threads;
      {
        const std::lock_guard lock(mutex_);
        threads.swap(threads_);
      }
      if (threads.empty()) return;
      for (std::thread& thread : threads) thread.join();
    }
  }
  std::mutex mutex_;
  std::list<std::thread> threads_;
  std::exception_ptr error_;
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

/// The same where `threads` may be 1: then as one block, on the calling thread.
template <class F>
void parallel_for_blocks(std::size_t count, std::size_t grain, int threads, const F& f) {
  if (threads == 1) {
    f(std::size_t{0}, count);
  } else {
    parallel_for_blocks(count, grain, f);
  }
}

/// Calls f(i) for each i in [0, count): for many, small pieces of work.
template <class F>
void parallel_for_indices(std::size_t count, const F& f) {
  parallel_for_blocks(count, 1, [&f](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) f(i);
  });
}

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
