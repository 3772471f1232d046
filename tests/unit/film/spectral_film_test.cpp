// What a film takes and hands out without copying.
#include "film/spectral_film.hpp"

#include <gtest/gtest.h>

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

TEST(SpectralFilm, HeldCountsAreThoseOfTheFilm) {
  SpectralFilm film({0, 0, 2, 1}, {1, 2, true, true});
  const HeldCountsView counts = film.held_counts();
  const HeldCounts before = counts.copy();
  const uint32_t samples[] = {3, 4};
  const float means[] = {1, 2};
  film.add({0, 1, samples, means, 1, 5});
  EXPECT_EQ(counts.samples[1], (std::vector<uint64_t>{3, 4}));
  EXPECT_EQ(counts.attempted[1][0], 5u);
  EXPECT_EQ(counts.block_samples[0][1], 7u);
  EXPECT_EQ(counts.block_sums[0][1], 11);
  EXPECT_EQ(before.samples[1], (std::vector<uint64_t>{0, 0}));
}

}  // namespace
}  // namespace kiloband
