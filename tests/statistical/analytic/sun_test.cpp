// Suns: directional lights with an angular radius r, of radiance L = E0 / (pi sin^2 r).
//
//   a diffuse plane that sees the whole disc: E = E0 cos theta, L = rho E / pi
//   seen by a camera, in a mirror and through a pane: L, R L and T L; those that overlap, and the sky behind them, add up
//
// Detectable bias: 0.5 %.
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::sun_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "400-402, 500-502, 690-700";
const Knots kIrradiance{{{400, 5}, {500, 1}, {600, 2}, {800, 3}}};
const Knots kReflectance{{{400, 0.2}, {600, 0.9}, {800, 0.5}}};

double radiance_of(double degrees) {
  return 1 / (kPi * std::pow(std::sin(degrees * kPi / 180), 2.0));
}

/// A sun of kIrradiance in the direction (x, y, z).
std::string sun(double degrees, double x, double y, double z) {
  return emitter("directional", kIrradiance.text("irradiance") + real("angular_radius", degrees) +
                                    number("vector", "direction", point(-x, -y, -z)));
}

class SunTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, SunTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(SunTest, LightsADiffusePlane) {
  const std::string plane =
      shape("rectangle", to_world(turn("x", "-90")) + bsdf("diffuse", kReflectance.text("reflectance")));
  const std::string camera = perspective(lookat("0.02, 0.29, -0.7", "0, 0, 0"), 0.05, film(8));
  for (const double degrees : {0.2666, 12.0})
    for (const double from_zenith : {0.0, 50.0, 77.0}) {
      SCOPED_TRACE(std::to_string(degrees) + " at " + std::to_string(from_zenith));
      const double a = from_zenith * kPi / 180;
      const std::string light = sun(degrees, 0.6 * std::sin(a), std::cos(a), 0.8 * std::sin(a));
      const RenderResult result =
          render_valid(scene(2, camera + plane + light), kBands, GetParam(), {160, 41});
      const Function radiance = [=](double nm) {
        return kIrradiance(nm) * kReflectance(nm) * std::cos(a) / kPi;
      };
      expect_image_mean(result, channel_integrals(radiance, result), 0.005);
    }
}

/// Two suns one behind the other, and a sky, seen at once: directly, and in a mirror.
TEST_P(SunTest, SeenDirectlyAndInAMirror) {
  const std::string sky = emitter("constant", kIrradiance.text("radiance"));
  const auto radiance = [](double nm) {
    return kIrradiance(nm) * (radiance_of(0.2666) + radiance_of(20) + 1);
  };
  const std::string lights = sun(0.2666, 0, 0.6, 0.8) + sky + sun(20, 0.1, 0.6, 0.8);
  const std::string direct = perspective(lookat("0, 0, 0", "0, 0.6, 0.8"), 0.02, film(4));
  const RenderResult seen = render_valid(scene(1, direct + lights), kBands, GetParam(), {8, 42});
  expect_image_mean(seen, channel_integrals(radiance, seen), 0.005);
  const std::string mirror = shape(
      "rectangle", to_world(turn("x", "-90")) + bsdf("conductor", kReflectance.text("specular_reflectance")));
  const std::string down = perspective(lookat("0, 0.6, -0.8", "0, 0, 0"), 0.02, film(4));
  const RenderResult mirrored = render_valid(scene(2, down + mirror + lights), kBands, GetParam(), {8, 43});
  const Function reflected = [&](double nm) { return kReflectance(nm) * radiance(nm); };
  expect_image_mean(mirrored, channel_integrals(reflected, mirrored), 0.005);
}

/// A pane at normal incidence lets (1 - R) / (1 + R) of it through, R = ((n - 1) / (n + 1))^2.
TEST(Sun, SeenThroughAPane) {
  const std::string pane =
      shape("rectangle",
            to_world(translate("0 0 1")) + bsdf("thindielectric", real("int_ior", 1.5) + real("ext_ior", 1)));
  const std::string camera = perspective(lookat("0, 0, 0", "0, 0, 1"), 0.02, film(4));
  const RenderResult result =
      render_valid(scene(-1, camera + pane + sun(0.2666, 0, 0, 1)), kBands, {}, {256, 44});
  const Function radiance = [](double nm) { return kIrradiance(nm) * radiance_of(0.2666) * 0.96 / 1.04; };
  expect_image_mean(result, channel_integrals(radiance, result), 0.005);
}

/// 16 and a lamp without radius are rendered, 17 are refused.
TEST(Sun, AtMostSixteen) {
  std::string suns = emitter("directional", kIrradiance.text("irradiance"));
  for (int i = 0; i < 16; ++i) suns += sun(1, 0, 0, 1);
  const std::string camera = perspective(lookat("0, 0, 0", "0, 0, 1"), 0.02, film(4));
  const RenderResult result = render_valid(scene(1, camera + suns), kBands, {}, {4, 46});
  const Function radiance = [](double nm) { return 16 * kIrradiance(nm) * radiance_of(1); };
  expect_image_mean(result, channel_integrals(radiance, result), 0.005);
  try {
    render_valid(scene(1, camera + suns + sun(1, 0, 0, 1)), kBands, {}, {4, 47});
    ADD_FAILURE() << "17 suns were taken";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("more than 16 directional emitters with an angular_radius"),
              std::string::npos)
        << error.what();
  }
}

/// hide_emitters: the camera sees none, a mirror does.
TEST(Sun, HiddenFromTheCamera) {
  const std::string hidden =
      "<integrator type='path'><boolean name='hide_emitters' value='true'/></integrator>";
  const std::string direct = perspective(lookat("0, 0, 0", "0, 0, 1"), 0.02, film(4));
  const RenderResult result = render_valid(
      "<scene version='3.0.0'>" + hidden + direct + sun(1, 0, 0, 1) + "</scene>", kBands, {}, {4, 45});
  expect_exactly(result, {0, 0, 0});
}

}  // namespace
}  // namespace kiloband::test::sun_test
