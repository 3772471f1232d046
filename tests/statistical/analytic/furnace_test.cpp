// White furnace: an object in an environment of radiance 1 from everywhere, unlimited depth. What is seen of
// it is its directional albedo (of transmitting objects: reflected and transmitted parts, back
// in air, together).
//
// A material that loses nothing must vanish: L = 1 in every pixel, whatever the path. Where each path's
// weight is 1 there is no variance at all and pixels are compared to rounding; else the image mean is tested.
// A convex object that only reflects is hit once, so these values hold for each direction by itself.
//   plastic, eta the index ratio, F Fresnel's reflectance from outside, R_ext = 2 int F(c) c dc and
//   R_int = 1 - (1 - R_ext) / eta^2 (reciprocity) the diffuse reflectances of the boundary:
//     albedo(c) = F(c) + (1 - F(c)) (1 - R_ext) / eta^2 * rho / (1 - rho' R_int),
//     rho' = rho if nonlinear, else 1;
//   for rho = 1 both are 1.
// Rough materials: furnace_rough_test.cpp.
//
// Error rate: 1e-4 for the whole program. Detectable bias: 0.3 % unless stated otherwise.
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/analytic_test.hpp"
#include "tests/statistical/analytic/fresnel_exact.hpp"

namespace kiloband::test::furnace_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "400-500, 500-501, 900-1000";  // outside the visible too

std::vector<double> widths(const RenderResult& result, double radiance = 1) {
  return channel_integrals([=](double) { return radiance; }, result);
}

/// A sphere with the sky around it.
std::string furnace(const std::string& material) {
  return scene(-1,
               perspective(lookat("0, 0, 3", "0, 0, 0"), 50, film(16)) + shape("sphere", material) + sky(1));
}

/// A plane z = 0 seen under the angle theta to its normal, in a plane that makes the angle
/// phi with its x axis.
std::string plane_furnace(const std::string& material, double theta, double phi = 0.4) {
  const std::string eye =
      point(5 * std::sin(theta) * std::cos(phi), 5 * std::sin(theta) * std::sin(phi), 5 * std::cos(theta));
  return scene(-1, perspective(lookat(eye, "0, 0, 0", "0.1, 0.2, 0.9"), 0.05, film(8)) +
                       shape("rectangle", to_world(scale("10, 10, 1")) + material) + sky(1));
}

struct Material {
  const char* name;
  std::string text;
};

// ---- lossless, without variance ----

TEST(Furnace, LosslessDeltaMaterialsVanish) {
  const std::string grey = diffuse(0.3);
  const std::vector<Material> materials = {
      {"mirror", bsdf("conductor", "")},
      {"two-sided mirror", bsdf("twosided", bsdf("conductor", ""))},
      {"dielectric", bsdf("dielectric", "")},
      {"dielectric, dense outside", bsdf("dielectric", real("int_ior", 1.0) + real("ext_ior", 1.5))},
      {"diamond", bsdf("dielectric", text("int_ior", "diamond"))},
      {"dielectric without boundary", bsdf("dielectric", real("int_ior", 1.3) + real("ext_ior", 1.3))},
      {"transparent mask", bsdf("mask", spectrum("opacity", 0) + grey)},
      {"half mirror", bsdf("mask", spectrum("opacity", 0.3) + bsdf("twosided", bsdf("conductor", "")))}};
  for (const Material& material : materials) {
    for (const Mode& mode : tried_modes()) {
      SCOPED_TRACE(material.name + std::string(" ") + name_of(mode));
      const RenderResult result = render_valid(furnace(material.text), kBands, mode, {2, 31, 16});
      expect_exactly(result, widths(result));
    }
  }
}

// ---- lossless, with variance ----

class LosslessTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, LosslessTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(LosslessTest, DiffuseAndPlasticVanish) {
  const std::string white = diffuse(1);
  const std::string nonlinear = yes("nonlinear");
  const std::vector<Material> materials = {
      {"diffuse", white},
      {"two-sided diffuse", bsdf("twosided", white)},
      {"half transparent diffuse", bsdf("mask", spectrum("opacity", 0.4) + bsdf("twosided", white))},
      {"plastic", bsdf("plastic", spectrum("diffuse_reflectance", 1))},
      {"nonlinear plastic", bsdf("plastic", spectrum("diffuse_reflectance", 1) + nonlinear)},
      {"two-sided plastic",
       bsdf("twosided", bsdf("plastic", spectrum("diffuse_reflectance", 1) + real("int_ior", 1.9)))}};
  for (const Material& material : materials) {
    SCOPED_TRACE(material.name);
    const RenderResult result = render_valid(furnace(material.text), kBands, GetParam(), {40, 32});
    expect_image_mean(result, widths(result), 0.003);
    expect_pixel(result, 8, 8, widths(result));
    expect_pixel(result, 3, 9, widths(result));
  }
}

/// The inside of a white sphere is lossless too, but has no exit: with half of the light lost at each bounce
/// and the sky seen through a transparent part of the wall, L_n -> 1.
/// Walls: white where opaque, half open everywhere.
TEST(Furnace, InsideOfAHalfOpenWhiteSphere) {
  const std::string wall = bsdf("mask", spectrum("opacity", 0.5) + bsdf("twosided", diffuse(1)));
  const RenderResult result = render_valid(
      scene(-1, perspective(lookat("0, 0.1, 0", "0, 0, -1"), 70, film(16)) + shape("sphere", wall) + sky(1)),
      kBands, {}, {16, 33});
  expect_image_mean(result, widths(result), 0.005);
}

// ---- known albedo: smooth plastic ----

TEST(Furnace, SmoothPlasticHasItsAlbedo) {
  constexpr double kEta = 1.5;
  for (const bool nonlinear : {false, true}) {
    for (const double rho : {0.0, 0.3, 0.8}) {
      const std::string material = bsdf(
          "plastic", spectrum("diffuse_reflectance", rho) + real("int_ior", kEta) + real("ext_ior", 1.0) +
                         "<boolean name=\"nonlinear\" value=\"" + (nonlinear ? "true" : "false") + "\"/>");
      const double external = diffuse_reflectance(kEta);
      const double internal = 1 - (1 - external) / (kEta * kEta);
      for (const double degrees : {10.0, 50.0, 75.0}) {
        SCOPED_TRACE("nonlinear " + std::to_string(nonlinear) + " rho " + std::to_string(rho) + " angle " +
                     std::to_string(degrees));
        const double theta = degrees * kPi / 180;
        const double reflected = dielectric_reflectance(std::cos(theta), kEta);
        const double base = rho / (1 - (nonlinear ? rho : 1) * internal) * (1 - external) / (kEta * kEta);
        const RenderResult result = render_valid(plane_furnace(material, theta), kBands, {}, {32, 34});
        expect_image_mean(result, widths(result, reflected + (1 - reflected) * base),
                          rho == 0 ? 0.03 : 0.005);
      }
    }
  }
}

/// Light inside leaves a coating of index 30 by 0.014 % of its directions; of index 1000, the largest there is, by 4 in
/// a million. A white base returns all that enters, 1 - F, all the same. Detectable bias: 0.5 %.
TEST(Furnace, PlasticOfALargeIndexLosesNothing) {
  for (const double eta : {30.0, 200.0, 1000.0}) {
    for (const bool nonlinear : {false, true}) {
      const std::string material = bsdf(
          "plastic", spectrum("diffuse_reflectance", 1) + spectrum("specular_reflectance", 0) +
                         real("int_ior", eta) + real("ext_ior", 1.0) + (nonlinear ? yes("nonlinear") : ""));
      for (const double degrees : {10.0, 60.0}) {
        SCOPED_TRACE("nonlinear " + std::to_string(nonlinear) + " eta " + std::to_string(eta) + " angle " +
                     std::to_string(degrees));
        const double theta = degrees * kPi / 180;
        const RenderResult result = render_valid(plane_furnace(material, theta), kBands, {}, {32, 35});
        expect_image_mean(result, widths(result, 1 - dielectric_reflectance(std::cos(theta), eta)), 0.005);
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::furnace_test
