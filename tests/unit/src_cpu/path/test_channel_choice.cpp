// The channel that survives a dispersive refraction: probabilities, and what paths carry.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "src_cpu/path/channel_choice.hpp"

namespace kiloband::test::test_channel_choice {

using namespace cpu;
namespace {

BinnedThroughput all(float value) {
  BinnedThroughput carried;
  carried.fill(value);
  return carried;
}

/// How often each channel is chosen over a fine regular grid of u, and the probability that it states.
struct Frequencies {
  std::vector<double> chosen, stated;
};
Frequencies frequencies(const BinnedThroughput& carried, uint32_t channels) {
  constexpr int kSteps = 1 << 20;
  Frequencies f{std::vector<double>(channels), std::vector<double>(channels)};
  for (int i = 0; i < kSteps; ++i) {
    const ChannelChoice c =
        choose_channel(carried, channels, (static_cast<float>(i) + 0.5f) / static_cast<float>(kSteps));
    f.chosen[c.channel] += 1.0 / kSteps;
    f.stated[c.channel] = c.probability;
  }
  return f;
}

// A regular grid hits an interval of width p within 2 of 2^20 points; the even part is a second interval.
constexpr double kGridError = 6e-6;

TEST(ChannelChoice, ProbabilitiesAreFrequenciesAndSumToOne) {
  for (const uint32_t channels : {1u, 2u, 7u, 16u, 17u, 100u, 1000u}) {
    SCOPED_TRACE(channels);
    BinnedThroughput carried;
    for (uint32_t b = 0; b < KB_CHANNEL_BINS; ++b)
      carried[b] = b % 5 == 2 ? 0.0f : 1.0f / static_cast<float>(1 + b);
    const Frequencies f = frequencies(carried, channels);
    for (uint32_t k = 0; k < channels; ++k) {
      ASSERT_GE(f.stated[k], 0.1 / channels * (1 - 1e-6)) << k;
      ASSERT_NEAR(f.chosen[k], f.stated[k], kGridError) << k;
    }
    EXPECT_NEAR(std::accumulate(f.stated.begin(), f.stated.end(), 0.0), 1, 2e-6);
  }
}

TEST(ChannelChoice, WhitePathsChooseEvenly) {
  for (const uint32_t channels : {3u, 16u, 100u}) {
    const Frequencies f = frequencies(all(0.7f), channels);
    for (const double p : f.stated) ASSERT_NEAR(p, 1.0 / channels, 1e-7);
  }
}

TEST(ChannelChoice, BlackPathsChooseEvenly) {
  const Frequencies f = frequencies(all(0), 20);
  for (const double p : f.stated) EXPECT_FLOAT_EQ(static_cast<float>(p), 0.05f);
}

TEST(ChannelChoice, FollowsReflectancesOfThePath) {
  std::vector<float> bins(2 * KB_CHANNEL_BINS, 0.5f);
  for (uint32_t b = 0; b < KB_CHANNEL_BINS; ++b) bins[KB_CHANNEL_BINS + b] = b < 8 ? 0.2f : 0.8f;
  KbPathVertex vertex{};
  vertex.head = KB_KIND_SCALED | KB_VERTEX_SCATTER;
  vertex.scatter0 = 0.3f;
  BinnedThroughput carried = all(1);
  carry(carried, vertex, bins);  // grey: nothing changes but the scale
  EXPECT_FLOAT_EQ(carried[0], carried[15]);
  vertex.row_a = 1;
  carry(carried, vertex, bins);
  carry(carried, vertex, bins);
  EXPECT_FLOAT_EQ(carried[0], 1.0f / 16);
  EXPECT_FLOAT_EQ(carried[15], 1);
  vertex.head = KB_KIND_TWO_TERM | KB_VERTEX_SCATTER;
  vertex.row_a = 0, vertex.row_b = 1;
  vertex.scatter0 = vertex.scatter1 = 1;
  carry(carried, vertex, bins);
  EXPECT_FLOAT_EQ(carried[0] / carried[15], (0.5f + 0.2f) / (0.5f + 0.8f) / 16);
  const BinnedThroughput before = carried;
  vertex.head |= KB_VERTEX_TEX_A;  // not known by bins
  carry(carried, vertex, bins);
  EXPECT_EQ(carried, before);
}

}  // namespace
}  // namespace kiloband::test::test_channel_choice
