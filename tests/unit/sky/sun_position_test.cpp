// The sun's place in the sky against almanac values and Mitsuba 3.9.1's sunsky.
#include "sky/sun_position.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sky/clear_sky.hpp"

namespace kiloband::test {
namespace {

/// Mitsuba's `sun_direction` of the same parameters: +X south, +Y west, +Z up.
struct Reference {
  PlaceAndTime at;
  double x, y, z;
};

TEST(SunPosition, IsMitsubas) {
  const Reference references[] = {
      {{35.6894, 139.6917, 9, 2010, 7, 10, 15, 0, 0}, 0.0513854, 0.691748, 0.720308},
      {{48, 2, 2, 2020, 3, 20, 10, 0, 0}, 0.372857, -0.86471, 0.336533},
      {{-33.9, 151.2, 10, 2023, 12, 21, 12, 30, 0}, -0.174982, 0.147957, 0.973391},
      {{60, 10, 1, 2022, 6, 21, 6, 15, 30}, -0.22053, -0.917159, 0.331941}};
  for (const Reference& r : references) {
    const SunPosition sun = sun_position(r.at);
    const double elevation = sun.elevation_deg * kDegree, azimuth = sun.azimuth_deg * kDegree;
    const double x = -std::cos(azimuth) * std::cos(elevation), y = -std::sin(azimuth) * std::cos(elevation);
    const double cosine = x * r.x + y * r.y + std::sin(elevation) * r.z;
    EXPECT_LT(std::acos(std::min(cosine, 1.0)) / kDegree, 0.06) << r.at.latitude_deg;
  }
}

/// At the June solstice the sun stands in the zenith of the Tropic of Cancer at its culmination, at the equinox in that of the
/// equator; at the pole it stands as high as its declination.
TEST(SunPosition, SolsticeAndEquinox) {
  const auto noon = [](double latitude, int month, int day, double hour) {
    return sun_position({latitude, 0, 0, 2010, month, day, hour, 0, 0}).elevation_deg;
  };
  EXPECT_GT(noon(23.44, 6, 21, 12 + 1.8 / 60), 89.8);  // equation of time: -1.8 min
  EXPECT_GT(noon(0, 3, 20, 12 + 7.5 / 60), 89.6);
  EXPECT_NEAR(noon(90, 6, 21, 12), 23.44, 0.01);
  EXPECT_NEAR(noon(-90, 6, 21, 12), -23.44, 0.01);
}

TEST(SunPosition, GoesFromEastToWest) {
  const auto azimuth = [](double hour) {
    return sun_position({50, 0, 0, 2010, 3, 20, hour, 0, 0}).azimuth_deg;
  };
  EXPECT_NEAR(azimuth(6.1), 90, 3);
  EXPECT_NEAR(azimuth(12.12), 180, 1);
  EXPECT_NEAR(azimuth(18.1), 270, 3);
}

}  // namespace
}  // namespace kiloband::test
