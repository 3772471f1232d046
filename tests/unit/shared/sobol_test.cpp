// Owen-scrambled Sobol points: the table against the direction numbers,
// stratification, unbiasedness, independence.
#include "shared/sobol.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "shared/sobol_table.h"
#include "tests/support/chi_square.hpp"

namespace kiloband::test {
namespace {

using Point = std::array<uint32_t, 4>;

Point to_point(kb_u32x4 x) {
  return {kb_u32x4_x(x), kb_u32x4_y(x), kb_u32x4_z(x), kb_u32x4_w(x)};
}

Point scrambled_point(uint32_t index, uint32_t key0, uint32_t key1, uint32_t block) {
  return to_point(kb_sobol_block(kb_sobol_table, kb_reverse_bits(index), key0, key1, block));
}

// Direction numbers by the recurrence of Joe and Kuo: s = degree, a = inner coefficients of the primitive
// polynomial, m_1..m_s initial numbers (file new-joe-kuo-6, dimensions 2 to 4).
std::array<std::array<uint32_t, 32>, 4> direction_numbers() {
  struct Polynomial {
    int s;
    uint32_t a;
    std::array<uint64_t, 3> m;
  };
  const std::array<Polynomial, 3> polynomials{{{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}}};
  std::array<std::array<uint32_t, 32>, 4> v{};
  for (int k = 0; k < 32; ++k) v[0][k] = 1u << (31 - k);
  for (int d = 1; d < 4; ++d) {
    const Polynomial& p = polynomials[d - 1];
    for (int k = 0; k < 32; ++k) {
      if (k < p.s) {
        v[d][k] = static_cast<uint32_t>(p.m[k] << (31 - k));
        continue;
      }
      v[d][k] = v[d][k - p.s] ^ (v[d][k - p.s] >> p.s);
      for (int i = 1; i < p.s; ++i)
        if (p.a >> (p.s - 1 - i) & 1) v[d][k] ^= v[d][k - i];
    }
  }
  return v;
}

Point plain_sobol(uint32_t index) {
  static const auto v = direction_numbers();
  Point x{};
  for (int d = 0; d < 4; ++d)
    for (int k = 0; k < 32; ++k)
      if (index >> k & 1) x[d] ^= v[d][k];
  return x;
}

// The first ten points of the sequence as printed by the program that Joe and Kuo distribute
// (Gray code order).
TEST(Sobol, DirectionNumbersGiveThePublishedPoints) {
  const double expected[10][3] = {{0, 0, 0},
                                  {.5, .5, .5},
                                  {.75, .25, .25},
                                  {.25, .75, .75},
                                  {.375, .375, .625},
                                  {.875, .875, .125},
                                  {.625, .125, .875},
                                  {.125, .625, .375},
                                  {.1875, .3125, .9375},
                                  {.6875, .8125, .4375}};
  for (uint32_t i = 0; i < 10; ++i) {
    const Point x = plain_sobol(i ^ (i >> 1));
    for (int d = 0; d < 3; ++d) EXPECT_EQ(x[d] / 4294967296.0, expected[i][d]) << i << ' ' << d;
  }
}

TEST(Sobol, TableMatchesTheDirectionNumbers) {
  // Every entry: an index that is one byte of the table, then mixed ones.
  std::vector<uint32_t> reversed;
  for (uint32_t byte = 0; byte < 4; ++byte)
    for (uint32_t value = 0; value < 256; ++value) reversed.push_back(value << (8 * byte));
  for (uint32_t i = 0; i < 1000; ++i) reversed.push_back(kb_mix32(i, 1));
  for (const uint32_t r : reversed) {
    const Point expected = plain_sobol(kb_reverse_bits(r));
    const Point x = to_point(kb_sobol_reversed(kb_sobol_table, r));
    for (int d = 0; d < 4; ++d) ASSERT_EQ(kb_reverse_bits(x[d]), expected[d]) << r << ' ' << d;
  }
}

// Nested scrambling: flipping bit b of x (from below, as reversed) leaves all result bits below b
// alone and flips b.
TEST(Sobol, OwenHashIsANestedPermutation) {
  for (uint32_t i = 0; i < 2000; ++i) {
    const uint32_t x = kb_mix32(i, 2), seed = kb_mix32(i, 3), b = i % 32;
    const uint32_t difference = kb_owen_reversed(x, seed) ^ kb_owen_reversed(x ^ (1u << b), seed);
    EXPECT_EQ(difference & ((2u << b) - 1), 1u << b);
  }
}

// All ways to cut the unit cube into 2^(m - t) boxes of 2^-k_d: each must hold exactly 2^t of the 2^m points.
void expect_net(const std::vector<Point>& points, int m, int t, int dimensions) {
  std::array<int, 4> k{};
  for (k[0] = 0; k[0] <= m - t; ++k[0])
    for (k[1] = 0; k[0] + k[1] <= m - t; ++k[1])
      for (k[2] = 0; k[0] + k[1] + k[2] <= (dimensions > 2 ? m - t : k[0] + k[1]); ++k[2]) {
        k[3] = m - t - k[0] - k[1] - k[2];
        if (dimensions == 2 && k[3] != 0) continue;
        std::vector<int> count(std::size_t{1} << (m - t));
        for (const Point& p : points) {
          uint64_t box = 0;
          for (int d = 0; d < 4; ++d) box = box << k[d] | (uint64_t{p[d]} >> (32 - k[d]));
          ++count[box];
        }
        for (const int c : count) ASSERT_EQ(c, 1 << t) << k[0] << ' ' << k[1] << ' ' << k[2] << ' ' << k[3];
      }
}

std::vector<Point> scrambled_points(int m, uint32_t first, uint32_t key0, uint32_t key1, uint32_t block) {
  std::vector<Point> points;
  for (uint32_t i = 0; i < 1u << m; ++i) points.push_back(scrambled_point(first + i, key0, key1, block));
  return points;
}

// Dimensions 0 and 1 are a (0, m, 2)-net in base 2: the first 2^m points,
// and every aligned run of 2^m points later.
TEST(Sobol, FirstTwoDimensionsHitEveryElementaryIntervalOnce) {
  for (int m = 0; m <= 10; ++m)
    for (uint32_t key = 0; key < 6; ++key)
      expect_net(scrambled_points(m, (key % 3) << m, kb_mix32(key, 5), kb_mix32(key, 6), key), m, 0, 2);
}

// The four dimensions are a (3, m, 4)-net: t is the sum of the degrees minus one, 0 + 0 + 1 + 2.
TEST(Sobol, FourDimensionsAreANet) {
  for (const int m : {4, 7, 9})
    for (uint32_t key = 0; key < 3; ++key)
      expect_net(scrambled_points(m, 0, kb_mix32(key, 7), kb_mix32(key, 8), 40 * key), m, 3, 4);
}

TEST(Sobol, EachDimensionIsStratified) {
  for (uint32_t key = 0; key < 8; ++key) {
    const auto points = scrambled_points(10, 0, kb_mix32(key, 9), key, key);
    for (int d = 0; d < 4; ++d) {
      std::set<uint32_t> strata;
      for (const Point& p : points) strata.insert(p[d] >> 22);
      EXPECT_EQ(strata.size(), 1024u);
    }
  }
}

TEST(Sobol, VanDerCorputIsStratified) {
  for (uint32_t key = 0; key < 20; ++key) {
    std::set<uint32_t> strata;
    for (uint32_t i = 0; i < 256; ++i) strata.insert(kb_van_der_corput(256 * key + i, key, 1) >> 24);
    EXPECT_EQ(strata.size(), 256u);
  }
}

// Over seeds, every point is uniform: for f = x, x^2, sqrt(y) z and x y z w the mean over 2^16 keys of the
// value at one index equals the integral. 16 z tests, each fails for one seed in 1e6; smallest bias found
// with probability 0.95: 6.6 s / 256, i.e. 0.74 % for f = x (1/2 +- 0.0074).
TEST(Sobol, EveryPointIsUnbiasedOverSeeds) {
  for (const uint32_t index : {0u, 1u, 2u, 1000003u}) {
    std::array<std::vector<double>, 4> f;
    for (uint32_t key = 0; key < 65536; ++key) {
      const Point p = scrambled_point(index, kb_mix32(key, 10), kb_mix32(key, 11), key % 7);
      const double x = p[0] * 0x1p-32, y = p[1] * 0x1p-32, z = p[2] * 0x1p-32, w = p[3] * 0x1p-32;
      f[0].push_back(x);
      f[1].push_back(x * x);
      f[2].push_back(std::sqrt(y) * z);
      f[3].push_back(x * y * z * w);
    }
    const std::array<double, 4> integral{1.0 / 2, 1.0 / 3, 1.0 / 3, 1.0 / 16};
    for (int i = 0; i < 4; ++i) EXPECT_LT(std::fabs(z_score(f[i], integral[i])), kMaxZ) << index << ' ' << i;
  }
}

// Means of 16 points: unbiased, and their spread far below that of independent points
// (1/sqrt(12 * 16) = 0.072 for f = x; scrambled nets: uniform within each of 16 strata,
// 1/sqrt(12)/16/4 = 0.0045).
TEST(Sobol, MeansOfPointSetsAreUnbiasedAndFarTighter) {
  std::vector<double> means;
  for (uint32_t key = 0; key < 4096; ++key) {
    double sum = 0;
    for (const Point& p : scrambled_points(4, 0, kb_mix32(key, 12), key, 3)) sum += p[2] * 0x1p-32 / 16;
    means.push_back(sum);
  }
  EXPECT_LT(std::fabs(z_score(means, 0.5)), kMaxZ);
  double square = 0;
  for (const double m : means) square += (m - 0.5) * (m - 0.5) / 4096;
  // relative standard error of a standard deviation from 4096 values: 1.1 %
  EXPECT_NEAR(std::sqrt(square), 1 / std::sqrt(12.0) / 64, 0.055 / std::sqrt(12.0) / 64);
}

// Joint uniformity of two coordinates, one from each of two point sets that should be independent, over keys:
// 8 x 8 cells, 65536 pairs; see chi_square.hpp for error rate;
// RMS errors of the cells from 3.1 % on are found.
void expect_independent(uint32_t index, const auto& key_a, const auto& key_b) {
  for (int d = 0; d < 4; ++d) {
    SquareCounts counts(8);
    for (uint32_t i = 0; i < 65536; ++i)
      counts.add(key_a(i, index)[d] * 0x1p-32, key_b(i, index)[(d + index) % 4] * 0x1p-32);
    EXPECT_GT(counts.p_value(), kTestLevel) << "index " << index << " dim " << d;
  }
}

TEST(Sobol, BlocksPixelsAndDimensionsAreIndependent) {
  const auto at = [](uint32_t pixel, uint32_t block) {
    return [=](uint32_t key, uint32_t index) {
      const kb_u64 k = kb_hash_pair(key, 0, pixel);
      return scrambled_point(index, kb_low32(k), kb_high32(k), block);
    };
  };
  for (const uint32_t index : {0u, 1u, 5u}) {
    expect_independent(index, at(0, 0), at(0, 1));
    expect_independent(index, at(0, 1), at(0, 2));
    expect_independent(index, at(0, 3), at(1, 3));
  }
}

// Within one key, over 64 indices: the correlation of a coordinate of one block with one of another is 0 on
// average over keys. Random orders would give it a standard deviation of 1/8; shuffling is nested instead:
// points 2 i and 2 i + 1 lie in opposite halves in either block, which makes it 1.22/8. z test over 4000 keys:
// finds a mean correlation of 6.6 * 1.22 / 8 / 63 = 0.016. The bound on the spread (standard error 1.1 %) sees
// blocks that move together for some keys.
TEST(Sobol, BlocksAreUncorrelatedOverTheIndex) {
  std::vector<double> correlations;
  for (uint32_t key = 0; key < 4000; ++key) {
    double product = 0;
    for (uint32_t i = 0; i < 64; ++i) {
      const double a = scrambled_point(i, kb_mix32(key, 13), key, 4)[key % 4] * 0x1p-32 - 0.5;
      const double b = scrambled_point(i, kb_mix32(key, 13), key, 5)[key / 4 % 4] * 0x1p-32 - 0.5;
      product += 12 * a * b / 64;
    }
    correlations.push_back(product);
  }
  EXPECT_LT(std::fabs(z_score(correlations, 0)), kMaxZ);
  double square = 0;
  for (const double c : correlations) square += c * c / 4000;
  EXPECT_LT(std::sqrt(square * 64), 1.3);
}

}  // namespace
}  // namespace kiloband::test
