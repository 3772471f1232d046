// Homogeneous gases: Beer-Lambert and emission along path and shadow rays, against closed forms that are
// integrated over each channel line by line.
//
// A ray through gas of coefficient kappa and temperature T over the length d in front
// of the radiance L0 shows
//   L = L0 exp(-kappa d) + B(T) (1 - exp(-kappa d)).
// The lines are Lorentz shapes of half width 0.05 nm every nanometre from 4500.5 to 4509.5 nm; channels are
// wider than the lines (10 nm, 1 nm), about as wide (0.1 nm on a line's flank) and narrower (0.004 nm).
//
// Error rate: 1e-4 for the whole program. Detectable bias: stated with each test; the variance is that of the
// wavelength, since nothing else is random in most of these scenes.
#include <algorithm>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/gas/gas_scenes.hpp"

namespace kiloband::test::gas_test {
namespace {

const char* const kBands = "4500-4510, 4503-4504, 4505.48-4505.58, 4506.54-4506.544";
constexpr double kLamp = 2e-3;  // W m^-2 sr^-1 nm^-1, about Planck's law at 300 K and 4.5 um
constexpr double kGasK = 450;

std::vector<double> expected(const RenderResult& result, const LineComb& comb, double lamp, double metres,
                             double temperature_k) {
  std::vector<double> values;
  for (const Channel& channel : result.scene.channels) {
    values.push_back(comb.integral(channel, [&](double nm, double kappa) {
      const double emitted = temperature_k > 0 ? planck_radiance(nm, temperature_k) : 0;
      return lamp * std::exp(-kappa * metres) - emitted * std::expm1(-kappa * metres);
    }));
  }
  return values;
}

class GasTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, GasTest, ::testing::ValuesIn(all_modes()), mode_name);

/// A slab between z = 0.5 and 1.5 in front of a lamp. Detectable bias: 5 %, that of the widest channel, where
/// 4096 wavelengths meet the cores of lines 400 times.
TEST_P(GasTest, SlabInFrontOfALamp) {
  const LineComb comb(2);
  for (const double temperature : {0.0, kGasK}) {
    SCOPED_TRACE(temperature);
    const std::string box = slab(0.5, 1.5, kNull + gas("interior", comb.text(), temperature));
    const RenderResult result =
        render_valid(scene(4, straight_camera(4) + black_lamp(spectrum("radiance", kLamp)) + box), kBands,
                     GetParam(), {64, 31});
    expect_image_mean(result, expected(result, comb, kLamp, 1, temperature), 0.05);
  }
}

/// The same slab, hit by a light sample between lamp and receiver: a point light of intensity I at height h
/// over a diffuse plane shows rho I / (pi h^2) exp(-kappa d) beside the camera's own way.
TEST_P(GasTest, ShadowRayThroughASlab) {
  const LineComb comb(2);
  const std::string plane = shape("rectangle", diffuse(0.8));
  const std::string light =
      emitter("point", spectrum("intensity", kLamp) + number("point", "position", "3.0123, 0.0057, 4"));
  // The box stands beside the camera's view: from z = 1 to 3, x from 0.5 to 2.9.
  const std::string box =
      shape("cube", to_world(step("scale", "x='1.2' y='1' z='1'") + step("translate", "x='1.7' z='2'")) +
                        kNull + gas("interior", comb.text()));
  const RenderResult result =
      render_valid(scene(2, straight_camera(4) + plane + light + box), kBands, GetParam(), {64, 32});
  // From (0.0123, 0) to (3.0123, 4): a straight line of length 5; z from 1 to 3 is its middle half.
  const double lamp = 0.8 / std::numbers::pi * kLamp / 25 * 0.8;
  expect_image_mean(result, expected(result, comb, lamp, 2.5, 0), 0.04);
}

double atmosphere_bias(const Mode& mode) {
  return mode.wavelengths == WavelengthMode::kShared ? 0.04 : 0.02;
}

/// An atmosphere along the camera ray and the light's: both lengths count,
/// and its emission along the camera ray.
TEST_P(GasTest, PointLightThroughAnAtmosphere) {
  const LineComb comb(0.3);
  const std::string plane = shape("rectangle", diffuse(0.8));
  const std::string light =
      emitter("point", spectrum("intensity", 10 * kLamp) + number("point", "position", "3.0123, 0.0057, 4"));
  const RenderResult result =
      render_valid(scene(2, straight_camera(4) + plane + light + gas("atmosphere", comb.text(), 300)), kBands,
                   GetParam(), {64, 33});
  const double lamp = 0.8 / std::numbers::pi * 10 * kLamp / 25 * 0.8;
  std::vector<double> values;
  for (const Channel& channel : result.scene.channels) {
    values.push_back(comb.integral(channel, [&](double nm, double kappa) {
      return lamp * std::exp(-kappa * 7) - planck_radiance(nm, 300) * std::expm1(-kappa * 2);
    }));
  }
  expect_image_mean(result, values, atmosphere_bias(GetParam()));
}

/// A square lamp of 2 m at a height of 1 m over the receiver, by light and BSDF samples together:
///   E = L0 int exp(-kappa r) cos^2 / r^2 dA, by the midpoint rule on 100 x 100 parts.
/// kappa is flat here. Detectable bias: 0.5 %.
TEST(Gas, AreaLightThroughAnAtmosphere) {
  constexpr double kKappa = 0.7;
  const std::string plane = shape("rectangle", to_world(scale("0.01")) + diffuse(0.8));
  const std::string light =
      shape("rectangle", to_world(turn("x", "180") + step("translate", "z='1'")) + diffuse(0) + lamp(5));
  const std::string view = perspective(lookat("0.3, 0, 0.4", "0, 0, 0"), 0.05, film(8));
  const RenderResult result =
      render_valid(scene(2, view + plane + light + gas("atmosphere", spectrum("absorption", kKappa))),
                   "500-510, 600-610", {}, {64, 34});
  double irradiance = 0;
  constexpr int kParts = 100;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; j < kParts; ++j) {
      const double x = (2 * i + 1.0) / kParts - 1, y = (2 * j + 1.0) / kParts - 1, r2 = x * x + y * y + 1;
      irradiance += 5 * std::exp(-kKappa * std::sqrt(r2)) / (r2 * r2) * 4 / (kParts * kParts);
    }
  }
  const double value = 10 * 0.8 / std::numbers::pi * irradiance * std::exp(-kKappa * (0.5 - 1e-4));
  expect_image_mean(result, {value, value}, 0.005);
}

/// From nearly nothing to black: a column of 1 m of flat gas, optical depths from 1e-8 to 1e4, seen against a
/// black wall. 1 - exp(-x) must keep its relative accuracy, which leaves nothing to sample
/// but the wavelength.
TEST(Gas, OpticalDepthsFromEmptyToBlack) {
  for (const double depth : {1e-8, 1e-4, 1e-2, 1.0, 30.0, 1e4}) {
    for (const Mode& mode : tried_modes()) {
      SCOPED_TRACE(std::to_string(depth) + " " + name_of(mode));
      const std::string box = slab(0.5, 1.5, kNull + gas("interior", spectrum("absorption", depth), 1000));
      const RenderResult result = render_valid(scene(2, straight_camera(2) + black_wall() + box),
                                               "4500-4500.001, 9000-9000.001", mode, {2, 35});
      std::vector<double> values;
      for (const Channel& c : result.scene.channels)
        values.push_back(-std::expm1(-depth) * planck_integral(c.min_nm, c.max_nm, 1000));
      expect_exactly(result, values);
    }
  }
}

/// Everything at 400 K, gas and walls that reflect (1 - rho) B + rho B: Planck's law in every channel
/// whatever the gas absorbs. Detectable bias: 0.5 %.
TEST_P(GasTest, IsothermalEnclosureShowsPlancksLaw) {
  const LineComb comb(3);
  for (const double reflectance : {0.0, 0.4}) {
    SCOPED_TRACE(reflectance);
    const std::string walls =
        shape("cube",
              yes("flip_normals") + diffuse(reflectance) +
                  emitter("area", "<spectrum name=\"radiance\" type=\"planck\">" + real("temperature", 400) +
                                      real("scale", 1 - reflectance) + "</spectrum>"));
    const std::string view = perspective(lookat("0.3, -0.2, 0.4", "-0.5, 0.1, -0.9"), 60, film(8));
    const RenderResult result = render_valid(scene(-1, view + walls + gas("atmosphere", comb.text(), 400)),
                                             kBands, GetParam(), {16, 36});
    std::vector<double> values;
    for (const Channel& c : result.scene.channels) values.push_back(planck_integral(c.min_nm, c.max_nm, 400));
    expect_image_mean(result, values, 0.005);
  }
}

/// Light of the environment on a diffuse plane: through a box above it, not through the atmosphere. The box
/// is so wide that every direction up to 89.4 degrees passes both of its faces.
///   E = 2 pi L int exp(-kappa d / c) c dc = 2 pi L E_3(kappa d)
/// Detectable bias: 0.5 %.
TEST(Gas, EnvironmentThroughABox) {
  const std::string plane = shape("rectangle", diffuse(0.7));
  const std::string box =
      shape("cube", to_world(step("scale", "x='200' y='200' z='0.5'") + step("translate", "z='0.6'")) +
                        kNull + gas("interior", spectrum("absorption", 0.5)));
  const std::string view = perspective(lookat("0.05, 0, 0.09", "0, 0, 0"), 0.05, film(8));
  const RenderResult result =
      render_valid(scene(2, view + plane + sky(3) + box + gas("atmosphere", spectrum("absorption", 1e-3))),
                   "500-510, 600-610", {}, {64, 39});
  double transmitted = 0;  // 2 E_3(0.5)
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double c = (i + 0.5) / kSteps;
    transmitted += 2 * c * std::exp(-0.5 / c) / kSteps;
  }
  const double value = 10 * 0.7 * 3 * transmitted * std::exp(-1e-3 * std::hypot(0.05, 0.09));
  expect_image_mean(result, {value, value}, 0.005);
}

/// Correlated k is exact here as well: one gas, a flat lamp, and a temperature at which Planck's law is flat
/// around 4.5 um. With stratified offsets it hardly varies.
/// Detectable bias: 0.4 %, with independent offsets per path 3 %.
TEST_P(GasTest, CorrelatedKOfOneGas) {
  const LineComb comb(2);
  const std::string choice = text("spectral", "correlated_k");
  const std::string box = slab(
      0.5, 1.5, kNull + medium("absorbing", "interior", comb.text() + real("temperature", 643.2) + choice));
  const RenderResult result =
      render_valid(scene(4, straight_camera(4) + black_lamp(spectrum("radiance", kLamp)) + box), kBands,
                   GetParam(), {64, 40});
  const Mode mode = GetParam();
  const bool random =
      mode.wavelengths == WavelengthMode::kPerPath && mode.sampler == SamplerType::kIndependent;
  expect_image_mean(result, expected(result, comb, kLamp, 1, 643.2), random ? 0.03 : 0.004);
}

/// A scene without gas is what it was: the same vertices, and no array for gas.
TEST(Gas, ASceneWithoutGasHasNothingOfIt) {
  const RenderResult result = render_valid(scene(4, straight_camera(2) + black_lamp(spectrum("radiance", 5))),
                                           "500-510", {}, {2, 41});
  EXPECT_FALSE(result.scene.features.gas);
  EXPECT_TRUE(result.scene.media.empty());
  EXPECT_TRUE(result.scene.interiors.empty());
  EXPECT_EQ(result.vertices, result.paths);
}

}  // namespace
}  // namespace kiloband::test::gas_test
