// How many blocks a device takes, and that every block is handed out once.
#include "render/devices/job_size.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <thread>

#include "render/devices/block_queue.hpp"

namespace kiloband {
namespace {

using Loads = std::vector<DeviceLoad>;

TEST(JobSize, IsHalfOfTheShareBySpeed) {
  const Loads loads{{3, 1}, {1, 1}};
  EXPECT_EQ(blocks_to_take(loads, 0, 80), 30u);
  EXPECT_EQ(blocks_to_take(loads, 1, 80), 10u);
}

TEST(JobSize, IsTheShareWhereHalfOfItLeavesTheDeviceIdle) {
  const Loads loads{{1, 16}, {1, 8}};
  EXPECT_EQ(blocks_to_take(loads, 0, 20), 10u);
  EXPECT_EQ(blocks_to_take(loads, 1, 20), 8u);
}

TEST(JobSize, KeepsAllOfTheDeviceBusyToItsEnd) {
  const Loads loads{{1, 4}, {1, 1}};
  EXPECT_EQ(blocks_to_take(loads, 0, 36), 12u);  // of a share of 18
  EXPECT_EQ(blocks_to_take(loads, 1, 36), 9u);
}

TEST(JobSize, OfUnknownSpeedIsSmall) {
  const Loads loads{{0, 64}, {0, 4}, {0, 1}};
  EXPECT_EQ(blocks_to_take(loads, 0, 96), 8u);
  EXPECT_EQ(blocks_to_take(loads, 1, 96), 4u);
  EXPECT_EQ(blocks_to_take(loads, 2, 96), 1u);
  EXPECT_EQ(blocks_to_take(loads, 0, 2), 1u);
}

TEST(JobSize, OfTheOnlyOneThatWorksIsEverything) {
  const Loads loads{{1, 1}, {5, 1, 0, false}};
  EXPECT_EQ(blocks_to_take(loads, 0, 7), 7u);
}

/// One block takes the slow device 10 s; the other has 9 in hand or before it.
TEST(JobSize, IsNoneWhereAnotherIsThroughBefore) {
  Loads loads{{0.1, 1}, {1, 1, 4}};
  EXPECT_EQ(blocks_to_take(loads, 0, 5), 0u);
  EXPECT_GE(blocks_to_take(loads, 0, 6), 1u);
  loads[1].works = false;
  EXPECT_EQ(blocks_to_take(loads, 0, 5), 5u);
}

TEST(JobSize, OfTheFastestIsNeverNone) {
  for (std::size_t left = 1; left < 40; ++left) {
    for (const double other : {0.01, 0.5, 1.0, 2.0, 2.5}) {
      const Loads loads{{2.5, 8}, {other, 1}, {other, 3}, {0, 1}};
      const std::size_t taken = blocks_to_take(loads, 0, left);
      EXPECT_GE(taken, 1u);
      EXPECT_LE(taken, left);
    }
  }
}

class Queue : public testing::Test {
 protected:
  static std::vector<uint32_t> numbers(uint32_t count) {
    std::vector<uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  const std::atomic<bool> never_{false};
};

TEST_F(Queue, HandsOutEveryBlockOnceAlsoThoseThatComeBack) {
  constexpr std::size_t kDevices = 4;
  Loads loads(kDevices);
  BlockQueue queue(numbers(500), loads, 1000);
  std::vector<std::vector<uint32_t>> delivered(kDevices);
  {
    std::vector<std::jthread> threads;
    for (std::size_t d = 0; d < kDevices; ++d) {
      threads.emplace_back([&, d] {
        for (int job = 1;; ++job) {
          const std::vector<uint32_t> taken = queue.take(d, never_);
          if (taken.empty()) return;
          if (d > 0 && job == 2) return queue.failed(d, taken);  // but for the first, all die at their second
          delivered[d].insert(delivered[d].end(), taken.begin(), taken.end());
          queue.done(d, static_cast<double>(d + 1));
        }
      });
    }
  }
  std::vector<uint32_t> all;
  for (const auto& some : delivered) all.insert(all.end(), some.begin(), some.end());
  std::ranges::sort(all);
  EXPECT_EQ(all, numbers(500));
  EXPECT_EQ(queue.left(), 0u);
}

TEST_F(Queue, GivesNoMoreThanItMay) {
  Loads loads(1);
  BlockQueue queue(numbers(10), loads, 4);
  EXPECT_EQ(queue.take(0, never_), (std::vector<uint32_t>{0, 1, 2, 3}));
}

TEST_F(Queue, EndsWhenItIsToldTo) {
  Loads loads(2);
  BlockQueue queue(numbers(10), loads, 4);
  const std::atomic<bool> stop{true};
  EXPECT_TRUE(queue.take(0, stop).empty());
  EXPECT_FALSE(queue.take(1, never_).empty());
  queue.close();
  EXPECT_TRUE(queue.take(0, never_).empty());
}

/// What the last device gives back has nobody to wait for.
TEST_F(Queue, EndsWhereNobodyWorks) {
  Loads loads(1);
  BlockQueue queue(numbers(3), loads, 9);
  queue.failed(0, queue.take(0, never_));
  EXPECT_EQ(queue.left(), 3u);
}

}  // namespace
}  // namespace kiloband
