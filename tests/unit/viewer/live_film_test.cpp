#include "viewer/live/live_film.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "viewer/live/live_render.hpp"

namespace kiloband::test {
namespace {

using namespace viewer;

constexpr SumRule kRule{SumRule::Kind::kFolded, 64, 64, 1};

LiveFilm small_film() {
  return {{0, 0, 40, 33}, {{{500, 510, ""}}, {{510, 520, ""}}}, {1, 1}, kRule, true};
}

/// What a backend does: one sample of every pixel of the next blocks.
template <class Sample>
void add_pass(LiveFilm& film, std::size_t most, const Sample& sample) {
  const SampleRange range = film.range();
  for (const uint32_t block : film.next_blocks(most)) {
    SpectralFilm& sums = film.film();
    sums.open_replicate(range.replicate, block);
    ASSERT_EQ(sums.attempted(range.replicate, block), range.first);
    for (std::size_t p = 0; p < sums.blocks()[block].pixels(); ++p) {
      const std::size_t pixel = sums.pixel_index(sums.blocks()[block], p);
      const PixelSums to = sums.pixel_sums(range.replicate, pixel);
      ++to.count;
      for (std::size_t k = 0; k < 2; ++k) to.open[k] += static_cast<float>(sample(pixel, k));
    }
    sums.set_attempted(range.replicate, block, range.first + 1);
  }
  film.finish_pass();
}

TEST(LiveFilm, MeansAreThoseOfAllSamplesAtAnyTime) {
  LiveFilm film = small_film();
  std::vector<float> row(40 * 2);
  film.means(0, row);
  EXPECT_TRUE(std::isnan(row[0]));
  double sum = 0;
  for (int pass = 1; pass <= 300; ++pass) {
    const double value = pass * pass % 17;
    sum += value;
    add_pass(film, 100, [&](std::size_t, std::size_t k) { return value + static_cast<double>(k); });
    film.means(32, row);
    EXPECT_NEAR(row[2 * 39], sum / pass, 1e-5) << pass;
    EXPECT_NEAR(row[2 * 39 + 1], sum / pass + 1, 1e-5) << pass;
    EXPECT_EQ(film.samples(), static_cast<uint64_t>(pass));
  }
}

/// The sums of a picture are those of the means, whatever was kept of earlier ones.
TEST(LiveFilm, SumsAreThoseOfTheMeans) {
  LiveFilm film = small_film();
  const RgbWeights weights{{1, 0, 0.5f}, {0, 2, 0.25f}};
  std::vector<float> row(40 * 2);
  const auto expect_sums = [&] {
    const Plane plane = weighted_plane(film, weights, 2);
    for (uint32_t y = 0; y < 33; ++y) {
      film.means(y, row);
      for (std::size_t x = 0; x < 40; ++x) {
        const float* const shown = &plane.values[3 * (y * 40 + x)];
        if (std::isnan(row[2 * x])) {
          EXPECT_TRUE(std::isnan(shown[0]));
          continue;
        }
        EXPECT_NEAR(shown[0], row[2 * x], 1e-5);
        EXPECT_NEAR(shown[1], 2 * row[2 * x + 1], 1e-5);
        EXPECT_NEAR(shown[2], 0.5 * row[2 * x] + 0.25 * row[2 * x + 1], 1e-5);
      }
    }
  };
  expect_sums();
  for (int pass = 0; pass < 80; ++pass) {
    add_pass(film, 3, [&](std::size_t pixel, std::size_t k) {
      return static_cast<double>((pixel + k) % 5) + pass % 3;
    });
    expect_sums();
  }
  film.restart();
  for (int pass = 0; pass < 4; ++pass) {
    add_pass(film, 100, [&](std::size_t pixel, std::size_t) { return static_cast<double>(pixel % 3); });
    expect_sums();
  }
}

/// Pictures that are made of sums which were kept as samples came are those of a film that was never asked before.
TEST(LiveFilm, KeptSumsChangeNoBit) {
  const RgbWeights weights{{1, 0.3f, 0.5f}, {0.1f, 2, 0.25f}};
  LiveFilm watched = small_film();
  for (int pass = 1; pass <= 40; ++pass) {
    LiveFilm fresh = small_film();
    const auto sample = [](std::size_t pixel, std::size_t k) {
      return 0.1 * static_cast<double>(pixel % 11) + static_cast<double>(k);
    };
    for (int i = 0; i < pass; ++i) add_pass(fresh, 100, sample);
    add_pass(watched, 100, sample);
    if (pass % 9 < 4) continue;  // nobody looks for a while
    ASSERT_EQ(weighted_plane(watched, weights, 2).values, weighted_plane(fresh, weights, 1).values) << pass;
  }
}

TEST(LiveFilm, PassesMayComeInParts) {
  LiveFilm film = small_film();
  add_pass(film, 3, [](std::size_t, std::size_t) { return 1.0; });
  EXPECT_EQ(film.passes(), 0u);
  std::vector<float> row(40 * 2);
  film.means(32, row);
  EXPECT_EQ(row[0], 1) << "the third block";
  EXPECT_TRUE(std::isnan(row[2 * 39])) << "the fourth";
  add_pass(film, 3, [](std::size_t, std::size_t) { return 1.0; });
  EXPECT_EQ(film.passes(), 1u);
}

/// 1320 pixels with normal samples of variance 4: after n samples the variance of the mean is 4 / n. The mean over the
/// pixels of its estimates is off by more than 5 % with a probability below 1e-6: each has at least 9 degrees of freedom, so a relative
/// deviation of sqrt(2 / 9), of their mean 0.9 % (two channels).
TEST(LiveFilm, VariancesAreThoseOfTheMean) {
  LiveFilm film = small_film();
  std::mt19937 random(7);
  std::normal_distribution<double> normal(3, 2);
  for (int pass = 1; pass <= 100; ++pass)
    add_pass(film, 100, [&](std::size_t, std::size_t) { return normal(random); });
  double sum = 0;
  std::vector<float> row(40 * 2);
  for (uint32_t y = 0; y < 33; ++y) {
    film.variances(y, row);
    for (const float v : row) sum += v;
  }
  EXPECT_NEAR(sum / (40 * 33 * 2), 4.0 / 100, 0.05 * 4.0 / 100);
  EXPECT_EQ(film.replicates(), 10u) << "of 1, 1, 2, 4, 8 and 5 times 16 samples";
}

TEST(LiveFilm, RestartedItIsAsNew) {
  LiveFilm used = small_film(), fresh = small_film();
  for (int pass = 0; pass < 30; ++pass) add_pass(used, 100, [](std::size_t, std::size_t) { return 1e3; });
  add_pass(used, 2, [](std::size_t, std::size_t) { return 1e3; });
  used.restart();
  std::vector<float> row(40 * 2), expected(40 * 2);
  used.means(0, row);
  EXPECT_TRUE(std::isnan(row[0]));
  const auto sample = [](std::size_t pixel, std::size_t k) {
    return 0.1 * static_cast<double>(pixel % 7 + k);
  };
  for (int pass = 0; pass < 20; ++pass) {
    add_pass(used, 100, sample);
    add_pass(fresh, 100, sample);
  }
  for (uint32_t y = 0; y < 33; ++y) {
    used.means(y, row);
    fresh.means(y, expected);
    EXPECT_EQ(row, expected);
    used.variances(y, row);
    fresh.variances(y, expected);
    EXPECT_EQ(row, expected);
  }
}

TEST(LiveFilm, HasAnEnd) {
  EXPECT_EQ(LiveFilm::most_samples(), kMostLiveSamples);
}

}  // namespace
}  // namespace kiloband::test
