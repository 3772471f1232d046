// Point, spot and directional lights and environments on a diffuse plane: L = rho E / pi (max_depth 2).
//
// The plane is y = 0, seen as in direct_area_test.cpp. Irradiance at the origin,
// theta the angle of incidence:
//   point of intensity I at distance d: E = I cos theta / d^2
//   spot: the same times the ramp (cutoff - angle) / (cutoff - beam) in the angle to its axis,
//     1 inside the beam
//   directional of irradiance E0 (across the direction): E = E0 cos theta
//   constant environment of radiance L0: E = pi L0
//   environment map: E = integral of L(omega) cos theta over the upper hemisphere, by quadrature. Between
//     texels L is bilinear in the azimuth phi (columns centred at (c + 1/2) / W of a turn) and the polar
//     angle (rows at r / (H - 1) of pi, the first at +Y); direction (sin phi sin theta, cos theta, -cos phi
//     sin theta).
//
// Lights of one direction have no variance but that of wavelength (shared by all paths).
// Detectable bias: 0.1 %; environments 0.5 %.
#include <cmath>
#include <numbers>

#include "spectral/colour/colour.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::direct_delta_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "400-402, 500-502, 690-700";
const Knots kIntensity{{{400, 5}, {500, 1}, {600, 2}, {800, 3}}};
const Knots kReflectance{{{400, 0.2}, {600, 0.9}, {800, 0.5}}};

std::string receiver() {
  return shape("rectangle", to_world(turn("x", "-90")) + bsdf("diffuse", kReflectance.text("reflectance")));
}
std::string camera() {
  return perspective(lookat("0.02, 0.29, -0.7", "0, 0, 0"), 0.05, film(8));
}

/// Renders the plane under the light and compares with `irradiance` per unit of kIntensity.
void expect_irradiance(const std::string& light, double irradiance, const Mode& mode, double largest_bias,
                       const Effort& effort = {32, 21}) {
  const RenderResult result = render_valid(scene(2, camera() + receiver() + light), kBands, mode, effort);
  const Function radiance = [=](double nm) { return kIntensity(nm) * kReflectance(nm) * irradiance / kPi; };
  if (irradiance == 0) return expect_exactly(result, {0, 0, 0});
  expect_image_mean(result, channel_integrals(radiance, result), largest_bias);
}

class DirectDeltaTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, DirectDeltaTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(DirectDeltaTest, PointLight) {
  struct {
    double x, y, z;
  } positions[] = {{0, 2, 0}, {1, 0.5, -0.3}, {-3, 0.05, 4}, {300, 400, 0}};
  for (const auto& p : positions) {
    SCOPED_TRACE(point(p.x, p.y, p.z));
    const double d2 = p.x * p.x + p.y * p.y + p.z * p.z;
    const std::string light =
        emitter("point", kIntensity.text("intensity") + number("point", "position", point(p.x, p.y, p.z)));
    expect_irradiance(light, p.y / std::sqrt(d2) / d2, GetParam(), 0.002);
  }
}

/// A spot at (0.6, 0.8, 0) m, 1 m from the origin under 36.9 degrees, whose axis passes the origin
/// by `aside` degrees.
TEST_P(DirectDeltaTest, SpotOnItsAxisAndInItsFalloff) {
  constexpr double kCutoff = 30, kBeam = 12;
  for (const double aside : {0.0, 8.0, 15.0, 25.0, 29.0, 31.0, 90.0}) {
    SCOPED_TRACE(aside);
    // The axis is turned in the plane z = 0: towards the origin it has the angle 180 + 53.13 degrees.
    const double angle = kPi + std::atan2(0.8, 0.6) + aside * kPi / 180;
    const std::string light = emitter(
        "spot", kIntensity.text("intensity") + real("cutoff_angle", kCutoff) + real("beam_width", kBeam) +
                    to_world(lookat("0.6, 0.8, 0", point(0.6 + std::cos(angle), 0.8 + std::sin(angle), 0),
                                    "0, 0, 1")));
    const double ramp = std::clamp((kCutoff - aside) / (kCutoff - kBeam), 0.0, 1.0);
    expect_irradiance(light, 0.8 * ramp, GetParam(), 0.002);
  }
}

TEST_P(DirectDeltaTest, DirectionalLight) {
  for (const double degrees : {0.0, 30.0, 60.0, 88.0, 100.0}) {
    SCOPED_TRACE(degrees);
    const double a = degrees * kPi / 180;
    const std::string light =
        emitter("directional",
                kIntensity.text("irradiance") +
                    number("vector", "direction", point(std::sin(a) * 0.6, -std::cos(a), std::sin(a) * 0.8)));
    expect_irradiance(light, std::max(0.0, std::cos(a)), GetParam(), 0.002);
  }
}

TEST_P(DirectDeltaTest, ConstantEnvironment) {
  expect_irradiance(emitter("constant", kIntensity.text("radiance")), kPi, GetParam(), 0.005, {64, 22});
}

// ---- environment map ----

constexpr uint32_t kWidth = 8, kHeight = 5;

/// Bilinear lookup of a latitude-longitude image at u in [0, 1) of a turn and v in [0, 1].
double lookup(const std::vector<float>& image, double u, double v) {
  const double x = u * kWidth - 0.5, y = v * (kHeight - 1);
  const int x0 = static_cast<int>(std::floor(x)),
            y0 = std::min(static_cast<int>(y), static_cast<int>(kHeight) - 2);
  const double fx = x - x0, fy = y - y0;
  const auto at = [&](int column, int row) {
    return double{image[row * kWidth + (column + kWidth) % kWidth]};
  };
  return (1 - fy) * ((1 - fx) * at(x0, y0) + fx * at(x0 + 1, y0)) +
         fy * ((1 - fx) * at(x0, y0 + 1) + fx * at(x0 + 1, y0 + 1));
}

/// Integral over the hemisphere about `normal` by the midpoint rule in u and v, error below 1e-4.
double environment_irradiance(const std::vector<float>& image, const std::array<double, 3>& normal) {
  constexpr int kColumns = 1600, kRows = 1600;
  double sum = 0;
  for (int r = 0; r < kRows; ++r) {
    const double v = (r + 0.5) / kRows, sin_theta = std::sin(kPi * v), cos_theta = std::cos(kPi * v);
    for (int c = 0; c < kColumns; ++c) {
      const double u = (c + 0.5) / kColumns, phi = 2 * kPi * u;
      const double cosine = normal[0] * std::sin(phi) * sin_theta + normal[1] * cos_theta -
                            normal[2] * std::cos(phi) * sin_theta;
      if (cosine > 0) sum += lookup(image, u, v) * cosine * sin_theta;
    }
  }
  return sum * 2 * kPi * kPi / kRows / kColumns;
}

/// One bright texel at several places of the map (at its seam too), seen by planes of two inclinations. Grey
/// pixels of an RGB map mean D65 times their value. Detectable bias: 0.5 %.
TEST(DirectDelta, EnvironmentMapWithOneBrightTexel) {
  const TemporaryFolder folder;
  for (const auto& [column, row] : {std::pair{2u, 1u}, {0u, 1u}, {7u, 2u}, {5u, 0u}}) {
    SCOPED_TRACE("texel " + std::to_string(column) + " " + std::to_string(row));
    std::vector<float> image(kWidth * kHeight, 0.01f);
    image[row * kWidth + column] = 20;
    folder.write("map.pfm", pfm_image(kWidth, kHeight, 1, image));
    const std::string light = emitter("envmap", text("filename", "map.pfm") + real("scale", 2));
    const RenderResult result =
        render_valid(scene(2, camera() + receiver() + light), kBands, {}, {128, 23}, folder.path());
    const double irradiance = 2 * environment_irradiance(image, {0, 1, 0});
    const Function radiance = [&](double nm) {
      return illuminant_d65()(nm) * kReflectance(nm) * irradiance / kPi;
    };
    expect_image_mean(result, channel_integrals(radiance, result), 0.005);
  }
}

/// The map turned by 90 degrees about x: its pole +Y goes to +Z, so the plane's normal +Y is -Z of the map.
TEST(DirectDelta, EnvironmentMapTurned) {
  const TemporaryFolder folder;
  std::vector<float> image(kWidth * kHeight, 0.1f);
  image[2 * kWidth + 0] = 10;
  image[3 * kWidth + 6] = 5;
  folder.write("map.pfm", pfm_image(kWidth, kHeight, 1, image));
  const std::string light = emitter("envmap", text("filename", "map.pfm") + to_world(turn("x", "90")));
  const RenderResult result =
      render_valid(scene(2, camera() + receiver() + light), kBands, {}, {128, 24}, folder.path());
  const double irradiance = environment_irradiance(image, {0, 0, -1});
  const Function radiance = [&](double nm) {
    return illuminant_d65()(nm) * kReflectance(nm) * irradiance / kPi;
  };
  expect_image_mean(result, channel_integrals(radiance, result), 0.005);
}

/// The map itself, seen by a camera: the image mean over a narrow field is the bilinear
/// lookup in its direction.
TEST(DirectDelta, EnvironmentMapSeenDirectly) {
  const TemporaryFolder folder;
  std::vector<float> image;
  for (uint32_t i = 0; i < kWidth * kHeight; ++i) image.push_back(0.25f + static_cast<float>((i * 7) % 11));
  folder.write("map.pfm", pfm_image(kWidth, kHeight, 1, image));
  const std::string light = emitter("envmap", text("filename", "map.pfm"));
  for (const auto& [phi, theta] : {std::pair{0.3, 0.8}, {2.0, 1.6}, {4.4, 2.9}, {6.2, 0.2}}) {
    SCOPED_TRACE(phi);
    const std::string target =
        point(std::sin(phi) * std::sin(theta), std::cos(theta), -std::cos(phi) * std::sin(theta));
    const std::string sensor = perspective(lookat("0, 0, 0", target), 0.02, film(4));
    const RenderResult result = render_valid(scene(1, sensor + light), kBands, {}, {8, 25}, folder.path());
    const double value = lookup(image, phi / (2 * kPi), theta / kPi);
    expect_image_mean(
        result, channel_integrals([&](double nm) { return illuminant_d65()(nm) * value; }, result), 0.005);
  }
}

}  // namespace
}  // namespace kiloband::test::direct_delta_test
