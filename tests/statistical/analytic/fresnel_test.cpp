// Smooth boundaries, slabs and mirrors against Fresnel's formulas
// (fresnel_exact.hpp, double, independent code).
//
// A camera looks along one ray at a plane z = 0 under the angle theta. One light stands where the mirrored
// ray goes and emits in the first channel only, another where the refracted ray goes and emits in the second:
// one render shows
//   R L1                  in the first channel and
//   (1 - R) L2 / eta^2    in the second, eta the index of the far side over that of the camera's side:
// radiance shrinks by eta^2 when it leaves the denser side.
// A parallel slab, summing its inner reflections, shows
//   R L1 (1 + (1 - R)^2 / (1 - R^2)) = 2 R / (1 + R) L1   and
//   (1 - R)^2 / (1 - R^2) L2 = (1 - R) / (1 + R) L2,
// with the unpolarised R at each boundary, as the renderer has it. Conductors show R(n, k) per wavelength,
// without variance but that of the wavelength.
//
// Error rate: 1e-4 for the whole program. Detectable bias: transmission 0.2 %, reflection 1 % (4 % of the
// light at normal incidence: few paths take it; 3 % of slabs), conductors 0.2 %.
#include <numbers>

#include "tests/statistical/analytic/analytic_test.hpp"
#include "tests/statistical/analytic/fresnel_exact.hpp"

namespace kiloband::test::fresnel_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "400-410, 690-700";
constexpr double kWidth = 10, kUpper = 2, kLower = 3;  // channel width, nm; radiances

/// A point in the plane of incidence (x, z).
std::string in_plane(double angle_from_z, double distance) {
  return point(distance * std::sin(angle_from_z), 0, distance * std::cos(angle_from_z));
}

/// A square of half side 1.5 that faces the origin.
std::string light_at(const std::string& place, const std::string& radiance) {
  return shape("rectangle", to_world(scale("1.5, 1.5, 1") + lookat(place, "0, 0, 0", "0, 1, 0.01")) +
                                emitter("area", radiance));
}

std::string view(double theta) {
  return perspective(lookat(in_plane(-theta, 4), "0, 0, 0"), 0.05, film(8));
}

const Knots kFirst{{{390, kUpper}, {500, kUpper}, {501, 0}, {710, 0}}};
const Knots kSecond{{{390, 0}, {600, 0}, {601, kLower}, {710, kLower}}};

/// Lights for the mirrored ray and for the ray under theta_out to the other side.
std::string two_lights(double theta, double theta_out) {
  return light_at(in_plane(theta, 6), kFirst.text("radiance")) +
         light_at(in_plane(kPi - theta_out, 6), kSecond.text("radiance"));
}

std::string plate(const std::string& transform, const std::string& material) {
  return shape("rectangle", to_world(scale("3, 3, 1") + transform) + material);
}

std::string glass(double index) {
  return bsdf("dielectric", real("int_ior", index) + real("ext_ior", 1.0));
}

constexpr double kAngles[] = {0, 30, 56.31, 80};  // the third is Brewster's for 1.5

/// From outside and from inside (the plane turned over);
/// inside, 56.31 and 80 degrees are beyond the critical angle.
TEST(Fresnel, DielectricBoundary) {
  for (const double index : {1.5, 2.4}) {
    for (const bool inside : {false, true}) {
      for (const double degrees : kAngles) {
        SCOPED_TRACE(std::to_string(index) + (inside ? " inside " : " outside ") + std::to_string(degrees));
        const double theta = degrees * kPi / 180, eta = inside ? 1 / index : index;
        const double reflectance = dielectric_reflectance(std::cos(theta), eta);
        const double sin_out = std::sin(theta) / eta;
        const std::string surface = plate(inside ? turn("x", "180") : "", glass(index));
        const RenderResult result = render_valid(
            scene(-1, view(theta) + surface + two_lights(theta, sin_out < 1 ? std::asin(sin_out) : 0)),
            kBands, {}, {192, 51});
        const double transmitted = reflectance < 1 ? (1 - reflectance) / (eta * eta) : 0;
        expect_image_mean(result, {reflectance * kUpper * kWidth, transmitted * kLower * kWidth}, 0.01);
      }
    }
  }
}

/// A plate of 1 cm: inner reflections leave within centimetres of each other, all towards the same lights.
TEST(Fresnel, ParallelSlab) {
  for (const Mode& mode : tried_modes()) {
    for (const double degrees : {0.0, 50.0, 75.0}) {
      SCOPED_TRACE(name_of(mode) + " " + std::to_string(degrees));
      const double theta = degrees * kPi / 180, r = dielectric_reflectance(std::cos(theta), 1.5);
      const uint64_t samples = mode.sampler == SamplerType::kSobol ? 96 : 256;
      const std::string slab =
          shape("cube", to_world(scale("3, 3, 0.005") + step("translate", "z='-0.005'")) + glass(1.5));
      const RenderResult result =
          render_valid(scene(-1, view(theta) + slab + two_lights(theta, theta)), kBands, mode, {samples, 52});
      expect_image_mean(result, {2 * r / (1 + r) * kUpper * kWidth, (1 - r) / (1 + r) * kLower * kWidth},
                        0.03);
    }
  }
}

/// specular_reflectance and specular_transmittance scale the two parts.
TEST(Fresnel, SpecularFactors) {
  const double theta = kPi / 3, r = dielectric_reflectance(0.5, 1.5);
  const std::string tinted =
      bsdf("dielectric", real("int_ior", 1.5) + real("ext_ior", 1.0) + spectrum("specular_reflectance", 0.7) +
                             spectrum("specular_transmittance", 0.4));
  const RenderResult result = render_valid(
      scene(-1, view(theta) + plate("", tinted) + two_lights(theta, std::asin(std::sin(theta) / 1.5))),
      kBands, {}, {192, 53});
  expect_image_mean(result, {0.7 * r * kUpper * kWidth, 0.4 * (1 - r) / 2.25 * kLower * kWidth}, 0.01);
}

// ---- mirrors ----

const char* const kMetalBands = "400-410, 500-520, 690-700";
const Knots kIndex{{{390, 1.6}, {450, 1.5}, {550, 0.4}, {720, 0.2}}};
const Knots kExtinction{{{390, 1.9}, {450, 1.85}, {600, 2.9}, {720, 4.2}}};

std::string mirror_scene(double theta, const std::string& material) {
  return scene(
      -1, view(theta) + plate("", material) + light_at(in_plane(theta, 6), spectrum("radiance", kUpper)));
}

double metal_reflectance(double theta, double nm) {
  return fresnel_reflectance(std::cos(theta), {kIndex(nm), -kExtinction(nm)});
}

class FresnelMirrorTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, FresnelMirrorTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(FresnelMirrorTest, ConductorPerWavelength) {
  for (const double degrees : {0.0, 30.0, 60.0, 85.0}) {
    SCOPED_TRACE(degrees);
    const double theta = degrees * kPi / 180;
    const std::string metal =
        bsdf("conductor", kIndex.text("eta") + kExtinction.text("k") + spectrum("specular_reflectance", 0.9));
    const RenderResult result = render_valid(mirror_scene(theta, metal), kMetalBands, GetParam(), {32, 54});
    const auto expected =
        channel_integrals([=](double nm) { return 0.9 * kUpper * metal_reflectance(theta, nm); }, result);
    expect_image_mean(result, expected, 0.002);
  }
}

/// The same constants from a file of three columns.
TEST(Fresnel, ConductorFromFile) {
  const TemporaryFolder folder;
  std::string rows;
  for (const double nm : {390.0, 450.0, 550.0, 600.0, 720.0}) {
    rows +=
        std::to_string(nm) + " " + std::to_string(kIndex(nm)) + " " + std::to_string(kExtinction(nm)) + "\n";
  }
  folder.write("metal.txt", rows);
  const double theta = kPi / 4;
  const std::string metal = bsdf("conductor", text("metal", "metal.txt"));
  const RenderResult result =
      render_valid(mirror_scene(theta, metal), kMetalBands, {}, {32, 55}, folder.path());
  const auto expected =
      channel_integrals([=](double nm) { return kUpper * metal_reflectance(theta, nm); }, result);
  expect_image_mean(result, expected, 0.002);
}

/// The default conductor reflects everything, at every angle, exactly.
TEST(Fresnel, PerfectMirror) {
  for (const double degrees : {0.0, 45.0, 88.0}) {
    const RenderResult result =
        render_valid(mirror_scene(degrees * kPi / 180, bsdf("conductor", "")), kMetalBands, {}, {2, 56});
    expect_exactly(result, {kUpper * 10, kUpper * 20, kUpper * 10});
  }
}

}  // namespace
}  // namespace kiloband::test::fresnel_test
