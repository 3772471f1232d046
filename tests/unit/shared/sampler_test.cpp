// The map of random dimensions.
#include "shared/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "shared/sobol_table.h"
#include "tests/support/chi_square.hpp"

namespace kiloband::test {
namespace {

constexpr uint64_t kSeed = 0x0123456789abcdefull;

bool same(const KbFloat4& a, const KbFloat4& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

KbFloat4 sample_block(uint32_t sampler, uint64_t seed, uint32_t pixel, uint32_t sample, uint32_t replicate,
                      uint32_t index_in_replicate, uint32_t block) {
  const KbSamplerKey key = kb_sampler_key(sampler, seed, kb_sampler_root(seed), pixel, sample, replicate,
                                          index_in_replicate, kb_sobol_table);
  return kb_sampler_block(&key, block);
}

TEST(Sampler, BlocksOfABounce) {
  EXPECT_EQ(KB_BLOCK_CAMERA, 0u);
  EXPECT_EQ(kb_block_light(0), 1u);
  EXPECT_EQ(kb_block_bsdf(0), 2u);
  EXPECT_EQ(kb_block_light(7), 15u);
  EXPECT_EQ(kb_block_bsdf(7), 16u);
}

// The documented counter, whatever replicate the sample was dealt to.
TEST(Sampler, IndependentIsPhiloxOfPixelSampleBlock) {
  for (uint32_t block = 0; block < 5; ++block) {
    const KbPhilox4 r = kb_philox4x32({17, 23, block, 0}, {0x89abcdefu, 0x01234567u});
    const KbFloat4 u = sample_block(KB_SAMPLER_INDEPENDENT, kSeed, 17, 23, block, 5, block);
    EXPECT_EQ(u.x, kb_unit_float(r.x));
    EXPECT_EQ(u.y, kb_unit_float(r.y));
    EXPECT_EQ(u.z, kb_unit_float(r.z));
    EXPECT_EQ(u.w, kb_unit_float(r.w));
  }
  const KbPhilox4 mu = kb_philox4x32({17, 23, 0, 1}, {0x89abcdefu, 0x01234567u});
  EXPECT_EQ(kb_path_mu(KB_SAMPLER_INDEPENDENT, kSeed, 17, 23, 3, 4), kb_unit_float(mu.x));
  const KbPhilox4 degrade = kb_philox4x32({17, 23, 6, 2}, {0x89abcdefu, 0x01234567u});
  EXPECT_EQ(kb_degrade_sample(kSeed, 17, 23, 6), kb_unit_float(degrade.x));
}

// Every argument that should matter does;
// with sobol the sample itself enters only through its replicate and index.
TEST(Sampler, SobolDependsOnSeedPixelReplicateIndexBlock) {
  const auto sobol = [](uint64_t seed, uint32_t pixel, uint32_t sample, uint32_t replicate, uint32_t index,
                        uint32_t block) {
    return sample_block(KB_SAMPLER_SOBOL, seed, pixel, sample, replicate, index, block);
  };
  const KbFloat4 reference = sobol(kSeed, 1, 2, 3, 4, 5);
  EXPECT_TRUE(same(reference, sobol(kSeed, 1, 99, 3, 4, 5)));
  EXPECT_FALSE(same(reference, sobol(kSeed + 1, 1, 2, 3, 4, 5)));
  EXPECT_FALSE(same(reference, sobol(kSeed + (1ull << 32), 1, 2, 3, 4, 5)));
  EXPECT_FALSE(same(reference, sobol(kSeed, 2, 2, 3, 4, 5)));
  EXPECT_FALSE(same(reference, sobol(kSeed, 1, 2, 4, 4, 5)));
  EXPECT_FALSE(same(reference, sobol(kSeed, 1, 2, 3, 5, 5)));
  EXPECT_FALSE(same(reference, sobol(kSeed, 1, 2, 3, 4, 6)));
}

TEST(Sampler, SobolPointsOfAReplicateAreStratifiedInEachDimension) {
  std::set<int> x, y, z, w;
  for (uint32_t i = 0; i < 64; ++i) {
    const KbFloat4 u = sample_block(KB_SAMPLER_SOBOL, kSeed, 7, 16 * i + 3, 3, i, 2);
    x.insert(static_cast<int>(u.x * 64));
    y.insert(static_cast<int>(u.y * 64));
    z.insert(static_cast<int>(u.z * 64));
    w.insert(static_cast<int>(u.w * 64));
  }
  EXPECT_EQ(x.size() + y.size() + z.size() + w.size(), 256u);
}

TEST(Sampler, NumbersStayBelowOne) {
  for (uint32_t i = 0; i < 200'000; ++i) {
    const KbFloat4 u = sample_block(i & 1, kSeed, i, 0, 0, 0, 0);
    const float mu = kb_shared_mu(kSeed, 0, i, 0, 0);
    for (const float v : {u.x, u.y, u.z, u.w, mu}) {
      ASSERT_GE(v, 0.0f);
      ASSERT_LE(v, KB_ONE_MINUS_EPSILON);
      ASSERT_EQ(v * 16777216.0f, std::floor(v * 16777216.0f));
    }
  }
}

// Any 2^m points from a multiple of 2^m on have one in each of 2^m intervals, so a render can be extended.
TEST(Sampler, SharedAndPathMuAreStratified) {
  for (uint32_t replicate = 0; replicate < 16; ++replicate) {
    std::set<int> shared, path;
    for (uint32_t i = 64; i < 128; ++i) {
      shared.insert(static_cast<int>(kb_shared_mu(kSeed, replicate, 3, 1, i) * 64));
      path.insert(static_cast<int>(kb_path_mu(KB_SAMPLER_SOBOL, kSeed, 1234, 0, replicate, i) * 64));
    }
    EXPECT_EQ(shared.size(), 64u);
    EXPECT_EQ(path.size(), 64u);
  }
}

// 2^16 mu of different blocks, replicates and seeds at one index are uniform and pairwise independent of a
// neighbour: 16 x 16 cells of (mu, neighbour's mu), 65536 pairs;
// RMS errors of the cells from 4.6 % on are found.
TEST(Sampler, MuIsUniformAndIndependentAmongItsKeys) {
  const auto test = [](const char* name, const auto& pair) {
    SquareCounts counts(16);
    for (uint32_t i = 0; i < 65536; ++i) {
      const auto [a, b] = pair(i);
      counts.add(a, b);
    }
    EXPECT_GT(counts.p_value(), kTestLevel) << name;
  };
  const auto mu = [](uint64_t seed, uint32_t replicate, uint32_t x, uint32_t y) {
    return kb_shared_mu(seed, replicate, x, y, 3);
  };
  using Pair = std::pair<float, float>;
  test("blocks x", [&](uint32_t i) { return Pair{mu(1, 0, 2 * i, 0), mu(1, 0, 2 * i + 1, 0)}; });
  test("blocks y", [&](uint32_t i) {
    return Pair{mu(1, 0, i % 256, i / 256), mu(1, 0, i / 256, i % 256 + 256)};
  });
  test("replicates", [&](uint32_t i) { return Pair{mu(1, i, 0, 0), mu(1, i + 1, 1, 0)}; });
  test("seeds", [&](uint32_t i) { return Pair{mu(2 * i, 0, 0, 0), mu(2 * i + 1, 0, 0, 0)}; });
  test("mu and camera", [&](uint32_t i) {
    return Pair{kb_path_mu(KB_SAMPLER_SOBOL, 1, i, 0, 0, 0),
                sample_block(KB_SAMPLER_SOBOL, 1, i, 0, 0, 0, 0).x};
  });
  test("mu and degradation", [&](uint32_t i) {
    return Pair{kb_path_mu(KB_SAMPLER_INDEPENDENT, 1, i, 0, 0, 0), kb_degrade_sample(1, i, 0, 0)};
  });
}

// Replicate means of a smooth integrand are unbiased and independent: the variance of the mean of R = 16
// replicates is 1/16 of a replicate's, estimated by s^2/R. Over 2000 pixels the ratio of mean estimated and
// observed variance is 1 within 6 sqrt(2/2000 + 2/(15 * 2000)) = 0.20 (one failure in 1e8; correlated
// replicates give far larger ratios).
TEST(Sampler, SobolReplicatesGiveHonestErrorBars) {
  constexpr uint32_t kPixels = 2000, kReplicates = 16, kPerReplicate = 4;
  double estimated = 0, observed = 0;
  std::vector<double> means;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    double sum = 0, square = 0;
    for (uint32_t r = 0; r < kReplicates; ++r) {
      double m = 0;
      for (uint32_t i = 0; i < kPerReplicate; ++i) {
        const KbFloat4 u = sample_block(KB_SAMPLER_SOBOL, 5, pixel, i * kReplicates + r, r, i, 1);
        m += static_cast<double>(u.x) * u.y * u.z / kPerReplicate;
      }
      sum += m;
      square += m * m;
    }
    means.push_back(sum / kReplicates);
    estimated += (square - sum * sum / kReplicates) / (kReplicates - 1) / kReplicates / kPixels;
    observed += (sum / kReplicates - 0.125) * (sum / kReplicates - 0.125) / kPixels;
  }
  EXPECT_NEAR(estimated / observed, 1, 0.20);
  EXPECT_LT(std::fabs(z_score(means, 0.125)), kMaxZ);
}

}  // namespace
}  // namespace kiloband::test
