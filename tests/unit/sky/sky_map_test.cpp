// The map of the sky: its irradiances, its orientation, what it refuses.
#include "sky/sky_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/messages.hpp"
#include "tests/support/one_path_lights.hpp"

namespace kiloband::test {

using namespace cpu;
namespace {

constexpr double kPi = std::numbers::pi;

struct Irradiance {
  double horizontal = 0;   // on the plane that faces up
  double towards_sun = 0;  // on a plane that faces the sun, from within 3 degrees of it
};

/// The irradiances of the map interpolated as environment maps are,
/// by a midpoint rule of 6 x 6 points per texel.
Irradiance irradiance(const SkyMap& map, const std::vector<float>& values, std::size_t band, glm::dvec3 sun) {
  constexpr int kPoints = 6;
  const uint32_t width = map.width(), height = map.height();
  const std::size_t bands = map.bands().size();
  const auto at = [&](uint32_t x, uint32_t y) {
    return values[(std::size_t{y} * width + x % width) * bands + band];
  };
  Irradiance sum;
  for (uint32_t y = 0; y + 1 < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (int i = 0; i < kPoints * kPoints; ++i) {
        const double fx = (i % kPoints + 0.5) / kPoints, fy = (i / kPoints + 0.5) / kPoints;
        const double radiance = (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x + 1, y)) +
                                fy * ((1 - fx) * at(x, y + 1) + fx * at(x + 1, y + 1));
        const double theta = kPi * (y + fy) / (height - 1), phi = 2 * kPi * (x + 0.5 + fx) / width;
        const glm::dvec3 d(std::sin(theta) * std::sin(phi), std::cos(theta),
                           -std::sin(theta) * std::cos(phi));
        const double part =
            radiance * std::sin(theta) * kPi / (height - 1) * 2 * kPi / width / (kPoints * kPoints);
        sum.horizontal += part * std::max(0.0, d.y);
        if (glm::dot(d, sun) > std::cos(3 * kPi / 180)) sum.towards_sun += part * glm::dot(d, sun);
      }
  return sum;
}

glm::dvec3 sun_direction(const SkyParameters& sky) {
  const double e = sky.sun_elevation_deg * kPi / 180, a = sky.sun_azimuth_deg * kPi / 180;
  return {std::cos(e) * std::sin(a), std::sin(e), -std::cos(e) * std::cos(a)};
}

/// Band by band: global = direct cos + diffuse + thermal. The direct part alone is the difference to a map
/// whose sun is aside: within 3 degrees the scattered light is a few per mille.
TEST(SkyMap, IrradiancesAreTheModels) {
  for (const double elevation : {60.0, 15.0}) {
    const SkyParameters parameters{.sun_elevation_deg = elevation, .sun_azimuth_deg = 250};
    const ClearSky sky(parameters);
    const SkyMap map(sky,
                     {{400, 410, ""}, {550, 560, ""}, {900, 1000, ""}, {3500, 4000, ""}, {10000, 11000, ""}},
                     256, 129);
    std::vector<float> values(std::size_t{256} * 129 * 5);
    map.fill(0, 129, values);
    const double up = std::sin(elevation * kPi / 180);
    for (std::size_t b = 0; b < 5; ++b) {
      const Irradiance sum = irradiance(map, values, b, sun_direction(parameters));
      const double global = map.direct_normal(b) * up + map.diffuse(b) + map.thermal(b);
      EXPECT_NEAR(sum.horizontal / global, 1, 2e-3) << b;
      EXPECT_NEAR(map.direct_normal(b),
                  sky.direct_normal().mean(map.bands()[b].min_nm, map.bands()[b].max_nm), 1e-12);
      const double around = 2 * kPi * (1 - std::cos(3 * kPi / 180)) * 8 * map.diffuse(b) / kPi;
      EXPECT_NEAR(sum.towards_sun, map.direct_normal(b),
                  2e-3 * map.direct_normal(b) + around + 0.02 * map.thermal(b))
          << b;
    }
  }
}

/// By rows of the map, the thermal irradiance is that of the model's own integral over angle.
TEST(SkyMap, ThermalIrradiance) {
  const ClearSky sky({});
  const SkyMap map(sky, {{8000, 13000, ""}, {14000, 15000, ""}}, 16, 257);
  for (std::size_t b = 0; b < 2; ++b) {
    const Channel& band = map.bands()[b];
    EXPECT_NEAR(map.thermal(b) * band.width_nm() / sky.thermal_irradiance(band.min_nm, band.max_nm), 1, 5e-3)
        << b;
  }
}

/// The brightest texel is where environment maps look in the direction of the sun.
TEST(SkyMap, TheSunStandsWhereTheRendererLooks) {
  for (const auto& [elevation, azimuth] :
       {std::pair{30.0, 0.0}, {30.0, 90.0}, {55.0, 200.0}, {10.0, -45.0}}) {
    const SkyParameters parameters{.sun_elevation_deg = elevation, .sun_azimuth_deg = azimuth};
    const ClearSky sky(parameters);
    const SkyMap map(sky, {{550, 560, ""}}, 128, 65);
    std::vector<float> values(128 * 65);
    map.fill(0, 65, values);
    const auto brightest = std::ranges::max_element(values) - values.begin();
    KbEmitter emitter{};
    for (const int i : {0, 5, 10}) emitter.to_object[i] = emitter.to_world[i] = 1;
    const glm::vec2 uv = envmap_coordinates(emitter, glm::vec3(sun_direction(parameters)));
    const double turn = std::abs(static_cast<double>(brightest % 128) + 0.5 - uv.x * 128);
    EXPECT_LE(std::min(turn, 128 - turn), 1) << elevation << " " << azimuth;
    EXPECT_NEAR(static_cast<double>(brightest / 128), uv.y * 64, 1) << elevation << " " << azimuth;
  }
}

TEST(SkyMap, NightIsThermalAlone) {
  const ClearSky sky({.sun_elevation_deg = -10});
  const SkyMap map(sky, {{500, 510, ""}, {10000, 10100, ""}}, 16, 9);
  std::vector<float> values(16 * 9 * 2);
  map.fill(0, 9, values);
  for (std::size_t i = 0; i < values.size(); i += 2) {
    EXPECT_EQ(values[i] < 1e-20f, true) << i;  // Planck's law of the ground at 500 nm
    EXPECT_GT(values[i + 1], 1e-4f) << i;
  }
}

/// The ground radiates what it reflects and emits, and nothing else: a black one at its temperature.
TEST(SkyMap, Ground) {
  const ClearSky sky({.ground_temperature_k = 300, .ground_albedo = 0, .ground_emissivity = 1});
  const SkyMap map(sky, {{500, 510, ""}, {10000, 10000.1, ""}}, 16, 9);
  std::vector<float> values(16 * 9 * 2);
  map.fill(0, 9, values);
  for (std::size_t i = 16 * 5 * 2; i < values.size(); i += 2) {
    EXPECT_LT(values[i], 1e-20f);
    EXPECT_NEAR(values[i + 1], 9.924e-3, 1e-5);  // B(10 um, 300 K) = 9.924 W m^-2 sr^-1 um^-1
  }
}

TEST(SkyMap, DefaultBandsAreContiguous) {
  const ChannelList bands = default_sky_bands();
  EXPECT_EQ(bands.front().min_nm, 380);
  EXPECT_EQ(bands.back().max_nm, 20000);
  for (std::size_t b = 1; b < bands.size(); ++b) EXPECT_EQ(bands[b].min_nm, bands[b - 1].max_nm);
}

TEST(SkyMap, RefusesWhatItCannotDo) {
  const ClearSky sky({});
  const auto error = [&](const ChannelList& bands, uint32_t width, uint32_t height) {
    return error_of([&] { SkyMap(sky, bands, width, height); });
  };
  const ChannelList good{{500, 510, ""}};
  EXPECT_EQ(error(good, 16, 9), "accepted");
  EXPECT_EQ(error(good, 7, 9), "sky width 7: must be from 8 to 65535");
  EXPECT_EQ(error(good, 16, 8),
            "sky height 8: must be odd and from 5 to 65535, so that a row lies on the horizon");
  EXPECT_EQ(error({{290, 310, ""}}, 16, 9), "sky band 290-310 nm: the model goes from 300 to 100000 nm");
}

}  // namespace
}  // namespace kiloband::test
