// Spots with a texture and projectors on a diffuse plane: L = rho E / pi (max_depth 2).
//
// With (x, y, z) the unit direction away from the lamp in its own coordinates (+Z the axis, +Y up, +X left), theta the angle of
// incidence and d the distance:
//   spot: E = I T(u, v) falloff cos theta / d^2, (u, v) = 1/2 + (x, y) / (2 z tan cutoff): the first row of an image is at -Y
//   projector: a plane across its axis gets pi scale P at distance 1 wherever it is in the picture; its intensity is that over z^3
//     (distance^2 is 1 / z^2, the plane is tilted by z), so that E = pi scale P cos theta / (z^3 d^2). The picture stands as a camera
//     in its place sees it.
//
// Lights of one direction have no variance but that of wavelength. Detectable bias: 0.2 %.
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "spectral/colour/colour.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::projected_light_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "400-402, 500-502, 690-700";
const Knots kIntensity{{{400, 5}, {500, 1}, {600, 2}, {800, 3}}};
const Knots kReflectance{{{400, 0.2}, {600, 0.9}, {800, 0.5}}};
const glm::dvec3 kLamp(0.6, 0.8, 0);
/// Where lamps look at from kLamp: the origin is in every quarter of the picture.
const glm::dvec3 kTargets[] = {{0.15, 0, 0.1}, {-0.2, 0, 0.12}, {0.1, 0, -0.2}, {-0.1, 0, -0.15}};

Text place(const glm::dvec3& target) {
  return to_world(lookat(point(kLamp.x, kLamp.y, kLamp.z), point(target.x, target.y, target.z), "0, 0, 1"));
}

/// The direction from kLamp to the origin in the coordinates of a lamp that looks at `target`.
glm::dvec3 local_direction(const glm::dvec3& target) {
  const glm::dvec3 z = glm::normalize(target - kLamp), x = glm::normalize(glm::cross({0, 0, 1}, z));
  const glm::dvec3 y = glm::cross(z, x), out = -glm::normalize(kLamp);
  return {glm::dot(x, out), glm::dot(y, out), glm::dot(z, out)};
}

Text image(const Text& name, const Text& file = "image.pfm") {
  return "<texture name='" + name + "' type='bitmap'>" + text("filename", file) +
         text("filter_type", "nearest") + "</texture>";
}

/// 4 x 3 values, all different.
std::vector<float> values() {
  std::vector<float> list;
  for (int i = 0; i < 12; ++i) list.push_back(0.1f + 0.075f * static_cast<float>((i * 5) % 12));
  return list;
}
double value_at(double u, double v) {
  const int column = static_cast<int>(4 * u), row = static_cast<int>(3 * v);
  return double{values()[4 * row + column]};
}

/// The plane y = 0 at the origin under the lamp.
RenderResult lit_plane(const std::string& lamp, const Mode& mode, const TemporaryFolder& folder,
                       const Text& reflectance = kReflectance.text("reflectance")) {
  folder.write("image.pfm", pfm_image(4, 3, 1, values()));
  const std::string plane = shape("rectangle", to_world(turn("x", "-90")) + bsdf("diffuse", reflectance));
  const std::string camera = perspective(lookat("0.02, 0.29, -0.7", "0, 0, 0"), 0.05, film(8));
  return render_valid(scene(2, camera + plane + lamp), kBands, mode, {32, 51}, folder.path());
}

/// The plane shows `irradiance` times `light`.
void expect_irradiance(const RenderResult& result, double irradiance, const Function& light) {
  if (irradiance == 0) return expect_exactly(result, {0, 0, 0});
  const Function radiance = [&](double nm) { return light(nm) * kReflectance(nm) * irradiance / kPi; };
  expect_image_mean(result, channel_integrals(radiance, result), 0.002);
}

class ProjectedLightTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, ProjectedLightTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(ProjectedLightTest, SpotThrowsABitmap) {
  constexpr double kCutoff = 25, kBeam = 10;
  for (const glm::dvec3& target : kTargets) {
    SCOPED_TRACE(point(target.x, target.y, target.z));
    const TemporaryFolder folder;
    const std::string lamp =
        emitter("spot", kIntensity.text("intensity") + real("cutoff_angle", kCutoff) +
                            real("beam_width", kBeam) + image("texture") + place(target));
    const glm::dvec3 local = local_direction(target);
    const double edge = std::tan(kCutoff * kPi / 180) * local.z, angle = std::acos(local.z) * 180 / kPi;
    const double value = value_at(0.5 + 0.5 * local.x / edge, 0.5 + 0.5 * local.y / edge);
    const double ramp = std::clamp((kCutoff - angle) / (kCutoff - kBeam), 0.0, 1.0);
    expect_irradiance(lit_plane(lamp, GetParam(), folder), 0.8 * value * ramp, kIntensity);
  }
}

/// Its colours are those of reflectances.
TEST(ProjectedLight, SpotThrowsACheckerboard) {
  const Text board = "<texture name='texture' type='checkerboard'>" + spectrum("color0", 1) +
                     kReflectance.text("color1") + "</texture>";
  for (const glm::dvec3& target : kTargets) {
    SCOPED_TRACE(point(target.x, target.y, target.z));
    const TemporaryFolder folder;
    const std::string lamp = emitter("spot", kIntensity.text("intensity") + real("cutoff_angle", 25) +
                                                 real("beam_width", 25) + board + place(target));
    const glm::dvec3 local = local_direction(target);
    const bool first = (local.x > 0) == (local.y > 0);
    const Function light = [&](double nm) { return kIntensity(nm) * (first ? 1 : kReflectance(nm)); };
    expect_irradiance(lit_plane(lamp, {}, folder), 0.8, light);
  }
}

/// A spectrum fills the square of fov x fov; the origin is 9 to 14 degrees off the axis.
TEST(ProjectedLight, ProjectorOfASpectrum) {
  for (const double fov : {50.0, 20.0})
    for (const glm::dvec3& target : kTargets) {
      SCOPED_TRACE(std::to_string(fov) + " degrees, " + point(target.x, target.y, target.z));
      const TemporaryFolder folder;
      const std::string lamp = emitter(
          "projector", kIntensity.text("irradiance") + real("fov", fov) + real("scale", 1.7) + place(target));
      const glm::dvec3 local = local_direction(target);
      const double edge = std::tan(fov * kPi / 360) * local.z;
      const bool inside = std::abs(local.x) < edge && std::abs(local.y) < edge;
      expect_irradiance(lit_plane(lamp, {}, folder), inside ? 0.8 * kPi * 1.7 / std::pow(local.z, 3.0) : 0,
                        kIntensity);
    }
}

/// Times D65 where it says so; wider than high: 4 to 3.
TEST_P(ProjectedLightTest, ProjectorOfABitmap) {
  const double edge = std::tan(40 * kPi / 360);
  for (const bool d65 : {false, true})
    for (const glm::dvec3& target : {kTargets[d65], kTargets[2 + d65]}) {
      SCOPED_TRACE(std::to_string(d65) + " " + point(target.x, target.y, target.z));
      const TemporaryFolder folder;
      const Text picture = d65 ? "<spectrum name='irradiance' type='d65'>" + image("value") + "</spectrum>"
                               : image("irradiance");
      const std::string lamp = emitter("projector", picture + real("fov", 40) + place(target));
      const glm::dvec3 local = local_direction(target);
      // As a camera sees it: u to the right, -X, and v down, -Y.
      const double u = 0.5 - 0.5 * local.x / (edge * local.z),
                   v = 0.5 - 0.5 * local.y / (edge * 0.75 * local.z);
      const Function light = [&](double nm) { return d65 ? illuminant_d65()(nm) : 1; };
      expect_irradiance(lit_plane(lamp, GetParam(), folder),
                        0.8 * kPi * value_at(u, v) / std::pow(local.z, 3.0), light);
    }
}

/// A camera in the projector's place with its field of view sees on a wall across the axis the picture, each texel as the same
/// irradiance.
TEST(ProjectedLight, ProjectorsPictureAsACameraSeesIt) {
  const TemporaryFolder folder;
  folder.write("image.pfm", pfm_image(4, 3, 1, values()));
  const Text here = lookat("0.3, 0.2, 3", "0.3, 0.2, 0");
  const std::string wall =
      shape("rectangle", to_world(scale("9")) + bsdf("diffuse", spectrum("reflectance", 0.5)));
  const std::string camera = perspective(here, 40, film(size(8, 6)));
  const std::string lamp = emitter("projector", image("irradiance") + real("fov", 40) + to_world(here));
  const RenderResult result =
      render_valid(scene(2, camera + wall + lamp), kBands, {}, {4, 52}, folder.path());
  for (uint32_t y = 0; y < 6; ++y)
    for (uint32_t x = 0; x < 8; ++x) {
      SCOPED_TRACE(std::to_string(x) + " " + std::to_string(y));
      const double value = 0.5 * double{values()[4 * (y / 2) + x / 2]} / 9;
      expect_pixel(result, x, y, channel_integrals([&](double) { return value; }, result));
    }
}

/// Colours of an image are those of a reflectance; above 1, a multiple of one: 4 times the reflectance (1, 1/2, 1/4) is thrown on a white
/// plane here, and white light on a plane of that reflectance there. Colours of textures come from a table with an error below 1e-3.
TEST(ProjectedLight, ColoursAreThoseOfReflectances) {
  const TemporaryFolder folder;
  folder.write("colour.pfm", pfm_image(1, 1, 3, {4, 2, 1}));
  const auto projector = [](const Text& irradiance) {
    return emitter("projector", irradiance + real("fov", 40) + place(kTargets[0]));
  };
  const RenderResult thrown =
      lit_plane(projector(image("irradiance", "colour.pfm")), {}, folder, spectrum("reflectance", 1));
  const RenderResult painted = lit_plane(projector(spectrum("irradiance", 1)), {}, folder,
                                         "<rgb name='reflectance' value='1, 0.5, 0.25'/>");
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(thrown.image_mean[k] / painted.image_mean[k] / 4, 1, 1e-3) << k;
}

}  // namespace
}  // namespace kiloband::test::projected_light_test
