#include "base/deal_ranges.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace kiloband::test {
namespace {

TEST(DealRanges, EveryItemOnceForAnyNumberOfThreads) {
  for (const std::size_t items : {0u, 1u, 2u, 7u, 1000u}) {
    for (const unsigned threads : {0u, 1u, 2u, 3u, 16u}) {
      std::vector<std::atomic<int>> times(items);
      deal_ranges(items, threads, [&](std::size_t first, std::size_t end) {
        EXPECT_LT(first, end);
        for (std::size_t i = first; i < end; ++i) ++times[i];
      });
      for (std::size_t i = 0; i < items; ++i) EXPECT_EQ(times[i], 1) << items << " items, " << threads;
    }
  }
}

TEST(DealRanges, PartsAreEqualAndTheFirstIsTheCallers) {
  std::vector<std::size_t> sizes(4);
  std::thread::id first_by;
  deal_ranges(1002, 4, [&](std::size_t first, std::size_t end) {
    sizes[first / 250] = end - first;
    if (first == 0) first_by = std::this_thread::get_id();
  });
  EXPECT_EQ(sizes, (std::vector<std::size_t>{250, 251, 250, 251}));
  EXPECT_EQ(first_by, std::this_thread::get_id());
}

TEST(DealRanges, ThrowsWhatTheFirstPartThrewThatDid) {
  std::atomic<int> done{0};
  const auto work = [&](std::size_t first, std::size_t) {
    ++done;
    if (first >= 2) throw std::runtime_error(std::to_string(first));
  };
  try {
    deal_ranges(4, 4, work);
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "2");
  }
  EXPECT_EQ(done, 4);
}

TEST(DealItems, EachOnceByTheProcessorsThreads) {
  for (const std::size_t items : {0u, 1u, 3u, 1000u}) {
    std::vector<std::atomic<int>> times(items);
    std::vector<std::thread::id> by(items);
    deal_items(items, [&](std::size_t i) {
      ++times[i];
      by[i] = std::this_thread::get_id();
    });
    for (std::size_t i = 0; i < items; ++i) EXPECT_EQ(times[i], 1) << items << " items, " << i;
    if (items > 1 && std::thread::hardware_concurrency() > 1) {
      EXPECT_NE(by[0], by[1]) << "neighbours";
    }
  }
  EXPECT_THROW(deal_items(5,
                          [](std::size_t i) {
                            if (i == 3) throw std::runtime_error("3");
                          }),
               std::runtime_error);
}

TEST(DealRanges, LittleMemoryIsWorthOneThread) {
  EXPECT_EQ(threads_for(0), 1u);
  EXPECT_EQ(threads_for(1 << 20), 1u);
  EXPECT_LE(threads_for(uint64_t{1} << 40), std::max(std::thread::hardware_concurrency(), 1u));
}

}  // namespace
}  // namespace kiloband::test
