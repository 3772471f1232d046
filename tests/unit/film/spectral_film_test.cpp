// What a film takes and hands out without copying.
#include "film/spectral_film.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

namespace kiloband {
namespace {

TEST(SpectralFilm, HeldFilmsCountTheirSampleCounts) {
  FilmOptions options;
  options.channels = 1;
  options.replicates = 16;
  options.held = true;
  const std::size_t with_16 = SpectralFilm::bytes_per_pixel(options);
  options.replicates = 32;
  // Per replicate a float for the mean of the channel and 8 bytes for its number of samples.
  EXPECT_EQ(SpectralFilm::bytes_per_pixel(options) - with_16, 16u * (4 + 8));
}

FilmOptions with_sums(uint32_t replicates, bool held, uint32_t most_samples) {
  FilmOptions options;
  options.channels = 2;
  options.replicates = replicates;
  options.variance = true;
  options.held = held;
  options.sums = SumRule{};
  options.most_samples = most_samples;
  return options;
}

TEST(SpectralFilm, SumsTakeFourBytesAndTwelveBeyondAChunk) {
  const auto held = [](uint32_t replicates, uint32_t most) {
    return SpectralFilm::bytes_per_pixel(with_sums(replicates, true, most));
  };
  // Per replicate and channel; 4 more per replicate for its number of samples.
  EXPECT_EQ(held(32, 64) - held(16, 64), 16u * (2 * 4 + 4));
  EXPECT_EQ(held(32, 65) - held(16, 65), 16u * (2 * 12 + 4));
  const auto folded = [](uint32_t most) { return SpectralFilm::bytes_per_pixel(with_sums(16, false, most)); };
  EXPECT_EQ(folded(65) - folded(64), 2u * 8);
}

/// Puts sums of n samples of (1, 3) and (2, 5) per sample into the pixels of a replicate.
void put(SpectralFilm& film, uint32_t replicate, uint32_t n) {
  film.open_replicate(replicate, 0);
  for (std::size_t p = 0; p < 2; ++p) {
    const PixelSums sums = film.pixel_sums(replicate, p);
    sums.count = n;
    sums.open[0] = static_cast<float>((1.0 + static_cast<double>(p) + replicate) * n);
    sums.open[1] = static_cast<float>((3.0 + 2.0 * static_cast<double>(p) + replicate) * n);
  }
  film.set_attempted(replicate, 0, n);
}

/// Who watches the film hears of a block when its sums are there, and only then.
TEST(SpectralFilm, ObserversSeeTheNewSums) {
  SpectralFilm film({0, 0, 2, 1}, with_sums(3, false, 64));
  std::vector<float> seen;
  film.observe([&](uint32_t block) {
    EXPECT_EQ(block, 0u);
    seen.push_back(film.pixel_sums(1, 1).open[1]);
  });
  put(film, 1, 4);
  EXPECT_EQ(seen, std::vector<float>{4 * (3.0f + 2 + 1)});
  film.observe({});
  put(film, 1, 5);
  EXPECT_EQ(seen.size(), 1u);
}

TEST(SpectralFilm, SealsBreakWhereSumsMayHaveChanged) {
  FilmOptions options{2};
  options.sums = SumRule{};
  options.replicates = 2;
  SpectralFilm film({0, 0, 4, 3}, options), other({0, 0, 4, 3}, options);
  const SpectralFilm& same = film;
  EXPECT_EQ(film.seal(), 0u);
  const uint64_t first = film.seal_sums();
  EXPECT_NE(first, 0u);
  EXPECT_EQ(film.seal(), first);
  EXPECT_EQ(other.seal(), 0u);
  EXPECT_NE(other.seal_sums(), first);
  same.pixel_sums(0, 0), same.open_sums(0, 0, 4);  // who reads breaks nothing
  EXPECT_EQ(film.seal(), first);
  const std::vector<std::pair<const char*, std::function<void()>>> changes{
      {"pixel_sums", [&] { film.pixel_sums(0, 0); }},
      {"open_sums", [&] { film.open_sums(0, 0, 4); }},
      {"set_attempted", [&] { film.set_attempted(0, 0, 1); }},
      {"open_replicate", [&] { film.open_replicate(1, 0); }},
      {"finish_replicates", [&] { film.finish_replicates(); }},
      {"restart", [&] { film.restart(); }}};
  film.open_replicate(0, 0);
  for (const auto& [what, change] : changes) {
    const uint64_t seal = film.seal_sums();
    EXPECT_GT(seal, first);
    change();
    EXPECT_EQ(film.seal(), 0u) << what;
  }
}

TEST(SpectralFilm, PixelsLieInTheirBlocks) {
  const SpectralFilm film({40, 50, 70, 90}, with_sums(1, false, 64));
  for (uint32_t b = 0; b < film.blocks().size(); ++b)
    for (std::size_t p = 0; p < film.blocks()[b].pixels(); ++p)
      ASSERT_EQ(film.block_of(film.pixel_index(film.blocks()[b], p)), b) << p;
}

/// Both ways of keeping sums give what means that come at once give, moments included.
TEST(SpectralFilm, FoldedAndHeldSumsGiveTheMomentsOfTheirMeans) {
  SpectralFilm folded({0, 0, 2, 1}, with_sums(3, false, 64)), held({0, 0, 2, 1}, with_sums(3, true, 64));
  FilmOptions plain = with_sums(3, false, 64);
  plain.sums.reset();
  SpectralFilm means({0, 0, 2, 1}, plain);
  for (uint32_t r = 0; r < 3; ++r) {
    put(folded, r, 4 + r);
    put(held, r, 4 + r);
    const uint32_t counts[] = {4 + r, 4 + r};
    const auto shift = static_cast<float>(r);
    const float values[] = {1 + shift, 3 + shift, 2 + shift, 5 + shift};
    means.add({0, r, counts, values, 2});
  }
  EXPECT_EQ(folded.attempted(2, 0), 6u);
  EXPECT_EQ(folded.attempted(1, 0), 0u);  // closed, and its sums are gone
  folded.finish_replicates();
  for (const SpectralFilm* film : {&folded, &held}) {
    std::vector<float> mean(4), variance(4), expected_mean(4), expected_variance(4);
    film->row(0, mean, variance);
    means.row(0, expected_mean, expected_variance);
    EXPECT_EQ(mean, expected_mean);
    EXPECT_EQ(variance, expected_variance);
    EXPECT_EQ(film->samples(1, 0), 15u);
    EXPECT_EQ(film->image_moments().mean(0)[1], means.image_moments().mean(0)[1]);
  }
}

/// Sums with the factors that make means of them, against the means: moments, held means, image.
TEST(SpectralFilm, FactorsMakeMeansOfSums) {
  const uint32_t counts[] = {4, 3};
  const float sums[] = {1, 3, 0, 2, 5, 0}, factors[] = {0.25f, 1.0f / 3};
  const float means[] = {0.25f, 0.75f, 2 * factors[1], 5 * factors[1]};
  for (const bool held : {false, true}) {
    FilmOptions options = with_sums(2, held, 64);
    options.sums.reset();
    SpectralFilm from_sums({0, 0, 2, 1}, options), from_means({0, 0, 2, 1}, options);
    for (uint32_t r = 0; r < 2; ++r) {
      from_sums.add({0, r, counts, sums, 3, factors});
      from_means.add({0, r, counts, means, 2, {}});
    }
    std::vector<float> mean(4), expected(4);
    from_sums.row(0, mean, {});
    from_means.row(0, expected, {});
    EXPECT_EQ(mean, expected);
    EXPECT_EQ(mean[1], 0.75f);
    EXPECT_EQ(from_sums.image_moments().mean(0)[0], from_means.image_moments().mean(0)[0]);
  }
}

TEST(SpectralFilm, SumsBeyondAChunkAreThoseOfBothKinds) {
  const float open[] = {3}, tiny = 0x1p-26f;
  const ClosedSum folded[] = {std::bit_cast<ClosedSum>(97.0)};
  const ClosedSum compensated[] = {std::bit_cast<ClosedSum>(CompensatedSum{1, tiny})};
  float mean[1];
  mean_of_sums({}, 100, {100, open, folded}, mean);
  EXPECT_EQ(mean[0], 1.0f);
  mean_of_sums({}, 64, {64, open, folded}, mean);  // nothing is closed yet
  EXPECT_EQ(mean[0], 3.0f / 64);
  const float small[] = {7 *
                         tiny};  // 7/8 of half a unit in the last place: lost without what was lost before
  mean_of_sums({SumRule::Kind::kCompensated, 16, 16, 1}, 20, {1, small, compensated}, mean);
  EXPECT_EQ(mean[0], 1.0f + 8 * tiny);
  mean_of_sums({}, 5, {0, open, {}}, mean);
  EXPECT_EQ(mean[0], 0.0f);
}

/// A block that is set is as one to which replicates were added one after the other, and takes the next one.
TEST(SpectralFilm, SetBlocksGoOnAsAddedOnes) {
  FilmOptions options;
  options.channels = 2;
  options.replicates = 3;
  options.variance = true;
  const std::vector<uint32_t> counts{4, 2};
  const std::vector<std::vector<float>> replicates{{1, 3, 5, 7}, {2, 7, 4, 1}, {6, 2, 8, 3}};
  SpectralFilm added({0, 0, 2, 1}, options), film({0, 0, 2, 1}, options);
  for (uint32_t r = 0; r < 2; ++r) added.add({0, r, counts, replicates[r], 2});
  const std::vector<uint64_t> samples{8, 4}, of_replicates{6, 6};
  const std::vector<uint32_t> numbers{2, 2};
  const std::vector<float> mean{1.5f, 5, 4.5f, 4}, m2{2, 32, 1, 36};  // 4 (1/2)^2 2, ... by hand
  const std::vector<double> sums{4 * 1 + 2 * 5, 4 * 3 + 2 * 7, 4 * 2 + 2 * 4, 4 * 7 + 2 * 1};
  film.add({0, 2, counts, replicates[2], 2});  // forgotten
  film.set({0, samples, numbers, mean, m2, sums, of_replicates});
  const auto expect_equal = [&] {
    std::vector<float> mean_a(4), variance_a(4), mean_b(4), variance_b(4);
    added.row(0, mean_a, variance_a);
    film.row(0, mean_b, variance_b);
    EXPECT_EQ(mean_a, mean_b);
    EXPECT_EQ(variance_a, variance_b);
    std::vector<std::vector<double>> sums_a, sums_b;
    std::vector<uint64_t> counts_a, counts_b;
    added.add_image_sums(sums_a, counts_a);
    film.add_image_sums(sums_b, counts_b);
    EXPECT_EQ(sums_a, sums_b);
    EXPECT_EQ(counts_a, counts_b);
    for (uint32_t x = 0; x < 2; ++x) EXPECT_EQ(added.samples(x, 0), film.samples(x, 0));
  };
  expect_equal();
  EXPECT_TRUE(film.has(1, 0));
  EXPECT_FALSE(film.has(2, 0));
  for (SpectralFilm* one : {&added, &film}) one->add({0, 2, counts, replicates[2], 2});
  expect_equal();
}

/// An open replicate is forgotten; the next one begins with nothing.
TEST(SpectralFilm, SetBlocksHaveNoOpenReplicate) {
  SpectralFilm film({0, 0, 2, 1}, with_sums(3, false, 64));
  put(film, 0, 5);
  const std::vector<uint64_t> samples{8, 8}, counts{16};
  const std::vector<uint32_t> numbers{1, 1};
  const std::vector<float> mean{1, 2, 3, 4}, m2(4);
  const std::vector<double> sums{32, 48};
  film.set({0, samples, numbers, mean, m2, sums, counts});
  EXPECT_EQ(film.attempted(0, 0), 0u);
  film.open_replicate(1, 0);
  EXPECT_EQ(film.pixel_sums(1, 0).count, 0u);
  EXPECT_EQ(film.pixel_sums(1, 0).open[1], 0.0f);
  std::vector<float> row(4);
  film.row(0, row, {});
  EXPECT_EQ(row, mean);
  EXPECT_EQ(film.samples(1, 0), 8u);
}

TEST(SpectralFilm, SetRefusesOtherShapes) {
  SpectralFilm film({0, 0, 2, 1}, with_sums(3, false, 64)), held({0, 0, 2, 1}, with_sums(3, true, 64));
  const std::vector<uint64_t> samples{8, 8}, counts{16};
  const std::vector<uint32_t> numbers{1, 1};
  const std::vector<float> mean(4), few(3);
  const std::vector<double> sums(2);
  const BlockMoments right{0, samples, numbers, mean, mean, sums, counts};
  EXPECT_NO_THROW(film.set(right));
  EXPECT_THROW(held.set(right), std::logic_error);
  EXPECT_THROW(film.set({0, samples, numbers, few, mean, sums, counts}), std::logic_error);
  EXPECT_THROW(film.set({0, samples, numbers, mean, {}, sums, counts}), std::logic_error);
  EXPECT_THROW(film.set({0, samples, numbers, mean, mean, {}, counts}), std::logic_error);
}

}  // namespace
}  // namespace kiloband
