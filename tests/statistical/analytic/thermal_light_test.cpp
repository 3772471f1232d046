// Hot shapes as lights: closed forms of what a Lambertian plane sees of them,
// with next-event estimation and without.
//
//   sphere  of radius r at height h above a receiver of reflectance rho:
//           irradiance pi eps B (r/h)^2 straight below
//   disk    of radius r at height h, parallel: irradiance pi eps B r^2 / (r^2 + h^2) below its centre
// (radiative view factors, e.g. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-12 and
// C-8). A receiver that emits nothing (0 K) shows rho / pi times the irradiance. Without next-event
// estimation: a mask of opacity 1 - 2^-20 over the receiver would not do, so lights are given the ambient
// temperature instead, which is not sampled.
//
// Error rate: 1e-4 for the whole program. Detectable bias: stated with each test.
#include <cmath>
#include <numbers>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::thermal_light_test {
namespace {

const char* const kBands = "4000-4010, 10000-10020";
constexpr double kHot = 800, kRho = 0.6, kEmissivity = 0.7;

std::string grey(double reflectance) {
  return diffuse(reflectance);
}

/// Looks at the origin of a plane z = 0 from below the light, at a slant.
std::string receiver() {
  return perspective(lookat("3, 0, 1.5", "0, 0, 0", "0, 0, 1"), 0.05, film(4)) +
         shape("rectangle", to_world(scale("3")) + grey(kRho) + thermal(0));
}

std::vector<double> reflected(const RenderResult& result, double view_factor, double emissivity) {
  std::vector<double> expected;
  for (const Channel& c : result.scene.channels)
    expected.push_back(kRho * view_factor * emissivity * planck_integral(c.min_nm, c.max_nm, kHot));
  return expected;
}

/// A sphere, as a light and at the ambient temperature (an environment of 0 radiance stands in for what would
/// be seen past it). Detectable bias: 1 %, by BSDF samples alone 3 %.
TEST(ThermalLight, SphereAboveALambertianReceiver) {
  const double r = 0.5, h = 1.5;
  const std::string sphere = number("point", "center", "0, 0, 1.5") + real("radius", r);
  const double factor = r * r / (h * h);
  const RenderResult light =
      render_valid(scene(2, receiver() + shape("sphere", sphere + grey(1 - kEmissivity) + thermal(kHot))),
                   kBands, {}, {64, 71});
  expect_image_mean(light, reflected(light, factor, kEmissivity), 0.01);
  const RenderResult ambient = render_valid(
      scene(2, receiver() + shape("sphere", sphere + grey(1 - kEmissivity)) + thermal(kHot) + sky(0)), kBands,
      {}, {256, 72});
  EXPECT_EQ(ambient.scene.emitters.size(), 1u);  // the dark environment; the sphere is no light
  expect_image_mean(ambient, reflected(ambient, factor, kEmissivity), 0.03);
}

/// A disk whose front faces the receiver, and one that shows its black back: emissivity 1.
/// Detectable bias: 1 %.
TEST(ThermalLight, DiskShowsItsFrontOrItsBlackBack) {
  const double r = 0.8, h = 1.2;
  for (const bool front : {true, false}) {
    SCOPED_TRACE(front);
    const std::string way = front ? turn("x", "180") : "";
    const std::string disk = shape("disk", to_world(scale("0.8") + way + step("translate", "z='1.2'")) +
                                               grey(1 - kEmissivity) + thermal(kHot));
    const RenderResult result = render_valid(scene(2, receiver() + disk), kBands, {}, {64, 73});
    expect_image_mean(result, reflected(result, r * r / (r * r + h * h), front ? kEmissivity : 1), 0.01);
  }
}

/// The same disk as a mesh of two rectangles' triangles would need another factor; a square of half side a at
/// height h seen from below its centre: F = 4 / pi X / sqrt(1 + X^2) atan(X / sqrt(1 + X^2)), X = a / h.
/// Detectable bias: 1 %.
TEST(ThermalLight, MeshAboveALambertianReceiver) {
  const double x = 0.7 / 1.3, root = std::sqrt(1 + x * x);
  const double factor = 4 / std::numbers::pi * x / root * std::atan(x / root);
  const std::string square = shape("rectangle", to_world(scale("0.7") + step("translate", "z='1.3'")) +
                                                    bsdf("twosided", grey(1 - kEmissivity)) + thermal(kHot));
  const RenderResult result = render_valid(scene(2, receiver() + square), kBands, {}, {64, 74});
  expect_image_mean(result, reflected(result, factor, kEmissivity), 0.01);
}

/// hide_emitters: what has a temperature of its own is not seen by the camera, what has the ambient one is;
/// the ambient background, an environment, is not.
TEST(ThermalLight, HideEmitters) {
  const auto image_of = [](const std::string& body) {
    const std::string view = perspective(lookat("0, 0, 3", "0, 0, 0"), 20, film(4));
    return render_valid(scene(1, view + body, yes("hide_emitters")), kBands, {}, {4, 75});
  };
  const std::string plate = grey(0.5);
  EXPECT_EQ(image_of(shape("rectangle", plate + thermal(kHot))).image_mean[0], 0);
  const RenderResult ambient = image_of(shape("rectangle", plate) + thermal(kHot));
  EXPECT_NEAR(ambient.image_mean[0], 0.5 * planck_integral(4000, 4010, kHot), 1e-3 * ambient.image_mean[0]);
  EXPECT_EQ(image_of(shape("sphere", number("point", "center", "50, 0, 0")) + thermal(kHot)).image_mean[0],
            0);
}

/// Past all shapes a black body of the ambient temperature is seen. Detectable bias: 0.2 %.
TEST(ThermalLight, AmbientTemperatureIsTheBackground) {
  const RenderResult result = render_valid(
      scene(-1, perspective(lookat("0, 0, 3", "0, 0, 9"), 20, film(4)) + shape("sphere", "") + thermal(kHot)),
      kBands, {}, {16, 76});
  std::vector<double> expected;
  for (const Channel& c : result.scene.channels)
    expected.push_back(planck_integral(c.min_nm, c.max_nm, kHot));
  expect_image_mean(result, expected, 0.002);
}

/// A plate whose temperature rises linearly from 300 to 500 K across the image, by an image of two pixels and
/// by vertices: the mean over the plate is int B(T) dT / 200 K. Detectable bias: 0.5 %.
TEST(ThermalLight, TemperatureFieldsFollowThePlace) {
  const TemporaryFolder folder;
  // Between the texels' centres, a quarter from either end, the lookup is linear.
  folder.write("kelvin.pfm", pfm_image(2, 1, 1, {300, 500}));
  folder.write(
      "plate.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float kelvin\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "-1 -1 0 300\n1 -1 0 500\n1 1 0 500\n-1 1 0 300\n3 0 1 2\n3 0 2 3\n");
  const std::string by_image = shape(
      "rectangle", to_world(step("scale", "x='2' y='2' z='1'")) + grey(0.2) +
                       "<emitter type=\"thermal\"><texture type=\"bitmap\" name=\"temperature\"><string "
                       "name=\"filename\" value=\"kelvin.pfm\"/><string name=\"wrap_mode\" value=\"clamp\"/>"
                       "</texture></emitter>");
  const std::string by_vertex = shape("ply", text("filename", "plate.ply") + grey(0.2) +
                                                 emitter("thermal", text("temperature_attribute", "kelvin")));
  for (const std::string& plate : {by_image, by_vertex}) {
    SCOPED_TRACE(plate);
    const RenderResult result =
        render_valid(scene(1, plane_sensor(8) + plate), kBands, {}, {64, 77}, folder.path());
    std::vector<double> expected;
    for (const Channel& c : result.scene.channels) {
      double sum = 0;
      for (int i = 0; i < 2000; ++i) sum += planck_integral(c.min_nm, c.max_nm, 300 + 200 * (i + 0.5) / 2000);
      expected.push_back(0.8 * sum / 2000);
    }
    expect_image_mean(result, expected, 0.005);
  }
}

}  // namespace
}  // namespace kiloband::test::thermal_light_test
