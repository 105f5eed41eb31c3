#include "harness/run/timing.h"

#include <gtest/gtest.h>

#include <chrono>
#include <exception>
#include <map>
#include <stdexcept>
#include <thread>

namespace raystudy {
namespace {

/// Sleeps for a millisecond, says it took `seconds`, and writes down that it ran.
TimedWork work(const std::string& name, double seconds, std::string& order,
               std::map<std::string, std::vector<TimedSample>>& samples) {
  TimedWork w;
  w.name = name;
  w.run_once = [name, seconds, &order] {
    order += name;
    return Lap{seconds, {seconds / 4, 3 * seconds / 4}};
  };
  w.finished = [name, &samples](std::vector<TimedSample> s) { samples[name] = std::move(s); };
  w.failed = [](const std::exception_ptr&) { FAIL() << "must not fail"; };
  return w;
}

TEST(Timing, TakesTheTimeThatTheWorkMeasuredAndItsParts) {
  std::string order;
  std::map<std::string, std::vector<TimedSample>> samples;
  time_interleaved({work("a", 2.0, order, samples)}, {.repetitions = 3, .sample_seconds = 1});
  ASSERT_EQ(samples["a"].size(), 3U);
  for (const TimedSample& s : samples["a"]) {
    EXPECT_DOUBLE_EQ(s.seconds, 2.0);
    EXPECT_EQ(s.iterations, 1);
    EXPECT_EQ(s.parts, (std::vector<double>{0.5, 1.5}));
  }
  EXPECT_EQ(order, "aaa");
}

TEST(Timing, IteratesShortWorkWithinARepetition) {
  std::string order;
  std::map<std::string, std::vector<TimedSample>> samples;
  time_interleaved({work("a", 0.01, order, samples)}, {.repetitions = 2, .sample_seconds = 0.1});
  ASSERT_EQ(samples["a"].size(), 2U);
  EXPECT_GE(samples["a"][0].iterations, 10);
  EXPECT_NEAR(samples["a"][0].seconds, 0.01, 1e-12);
  EXPECT_NEAR(samples["a"][1].parts[1], 0.0075, 1e-12);
}

/// With two works of 40 repetitions each, the chance that a fair shuffle gives fewer than 10 changes from one to the other is
/// below 10⁻¹².
TEST(Timing, InterleavesRepetitionsAtRandom) {
  std::string order;
  std::map<std::string, std::vector<TimedSample>> samples;
  time_interleaved({work("a", 1, order, samples), work("b", 1, order, samples)}, {.repetitions = 40, .sample_seconds = 0.5});
  ASSERT_EQ(order.size(), 80U);
  int changes = 0;
  for (std::size_t i = 1; i < order.size(); ++i) changes += order[i] != order[i - 1] ? 1 : 0;
  EXPECT_GE(changes, 10);
  std::string again;
  time_interleaved({work("a", 1, again, samples), work("b", 1, again, samples)}, {.repetitions = 40, .sample_seconds = 0.5});
  EXPECT_NE(order, again) << "the order is not random";
}

TEST(Timing, OneFailureLeavesTheOthersAlone) {
  std::string order;
  std::map<std::string, std::vector<TimedSample>> samples;
  int runs = 0;
  std::string message;
  TimedWork bad;
  bad.name = "bad";
  bad.run_once = [&runs]() -> Lap {
    if (++runs == 2) throw std::runtime_error("broken");
    return {1, {}};
  };
  bad.finished = [](const std::vector<TimedSample>&) { FAIL() << "must not finish"; };
  bad.failed = [&message](const std::exception_ptr& error) {
    try {
      std::rethrow_exception(error);
    } catch (const std::runtime_error& e) {
      message = e.what();
    }
  };
  time_interleaved({bad, work("a", 1, order, samples)}, {.repetitions = 5, .sample_seconds = 0.5});
  EXPECT_EQ(message, "broken");
  EXPECT_EQ(runs, 2);
  EXPECT_EQ(samples["a"].size(), 5U);
}

}  // namespace
}  // namespace raystudy
