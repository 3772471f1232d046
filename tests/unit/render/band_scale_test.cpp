// Film values to bands: which channel, which scale, what is counted.
#include "render/band_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kiloband::band_scale_test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(BandScale, BandsTakeTheirChannelAndItsScale) {
  BandScale scale({2, 0}, {3, 5, 1e-30});
  const std::vector<float> film = {0.1f, 7, 0.2f};
  std::vector<double> exact(2);
  std::vector<float> stored(2);
  RangeLosses losses;
  scale.means(film.data(), exact, stored.data(), losses);
  EXPECT_EQ(exact, (std::vector<double>{double{0.2f} * 1e-30, double{0.1f} * 3}));
  EXPECT_EQ(stored, (std::vector<float>{static_cast<float>(double{0.2f} * 1e-30),
                                        static_cast<float>(double{0.1f} * 3)}));
  scale.variances(film.data(), exact, stored.data(), losses);
  EXPECT_EQ(exact, (std::vector<double>{double{0.2f} * 1e-30 * 1e-30, double{0.1f} * 3 * 3}));
  EXPECT_EQ(stored[0], 0);  // an error bar of 0 where there is one
  EXPECT_EQ(losses.underflowed_variances, 1u);
  EXPECT_EQ(losses.underflowed + losses.overflowed + losses.overflowed_variances, 0u);
}

/// 19 bands: whole vectors and a remainder.
TEST(BandScale, EveryLossIsCountedOnce) {
  constexpr std::size_t kBands = 19;
  std::vector<std::size_t> channels(kBands);
  for (std::size_t b = 0; b < kBands; ++b) channels[b] = b;
  for (std::size_t b = 0; b < kBands; ++b) {
    BandScale scale(channels, std::vector<double>(kBands, 1e-20));
    std::vector<float> film(kBands, 1), stored(kBands);
    std::vector<double> exact(kBands);
    RangeLosses losses;
    film[b] = 1e-30f;
    scale.means(film.data(), exact, stored.data(), losses);
    film[b] = 0;  // stays what it was
    scale.means(film.data(), exact, stored.data(), losses);
    EXPECT_EQ(losses.underflowed, 1u) << b;
    film[b] = -kInfinity;
    scale.means(film.data(), exact, stored.data(), losses);
    film[b] = std::nanf("");
    scale.means(film.data(), exact, stored.data(), losses);
    scale.variances(film.data(), exact, stored.data(), losses);
    film[b] = kInfinity;
    scale.variances(film.data(), exact, stored.data(), losses);
    EXPECT_EQ(losses.overflowed, 2u) << b;
    EXPECT_EQ(losses.overflowed_variances, 1u) << b;
    EXPECT_EQ(losses.underflowed, 1u) << b;
  }
}

}  // namespace
}  // namespace kiloband::band_scale_test
