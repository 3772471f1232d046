// What is asked of a thread between its steps.
#include "viewer/live/task_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

namespace kiloband::viewer {
namespace {

constexpr std::chrono::seconds kLong{20};

/// Who waits for the fifth step sees it, not a later one, though the thread never rests.
TEST(TaskThread, WhatWaitsIsDoneBeforeTheNextStep) {
  std::atomic<bool> asked{false};
  int steps = 0;  // of the thread alone
  TaskThread thread([&] {
    if (asked) ++steps;
    return true;
  });
  int seen = 0;
  const auto ready = [&] {
    asked = true;
    return steps >= 5;
  };
  EXPECT_TRUE(thread.perform_when(
      ready, [&] { seen = steps; }, kLong));
  EXPECT_EQ(seen, 5);
}

TEST(TaskThread, WhatIsNeverReadyIsNotDone) {
  TaskThread thread([] { return false; });
  bool done = false;
  EXPECT_FALSE(
      thread.perform_when([] { return false; }, [&] { done = true; }, std::chrono::milliseconds(30)));
  thread.perform([] {});
  EXPECT_FALSE(done);
}

/// A paused render answers, too.
TEST(TaskThread, AThreadAtRestIsWoken) {
  TaskThread thread([] { return false; });
  bool done = false;
  EXPECT_TRUE(thread.perform_when([] { return true; }, [&] { done = true; }, kLong));
  EXPECT_TRUE(done);
}

TEST(TaskThread, FailuresReachWhoAsked) {
  TaskThread thread([] { return false; });
  const auto fail = [] { throw std::out_of_range("no such pixel"); };
  EXPECT_THROW(thread.perform_when([] { return true; }, fail, kLong), std::out_of_range);
}

}  // namespace
}  // namespace kiloband::viewer
