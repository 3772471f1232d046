// Direct light of area emitters on a diffuse plane against closed forms of the irradiance E at a point:
// L = rho E / pi (max_depth 2).
//
// The receiving plane is y = 0 with normal +Y; the camera looks obliquely at a patch of about a millimetre
// around the origin, over which E is linear in position to 1e-6, so that the image mean is the value at the
// origin. Reflectance and radiance differ from channel to channel and are linear within each.
// With E per unit radiance:
//   sphere, radius R, centre at distance d under the angle theta to the normal, wholly above the horizon:
//     E = pi (R / d)^2 cos theta
//   disk of radius r parallel to the plane at height h, its axis at lateral distance a:
//     E = (pi / 2) (1 - (a^2 + h^2 - r^2) / sqrt((a^2 + h^2 + r^2)^2 - 4 a^2 r^2)),
//     for a = 0: pi r^2 / (r^2 + h^2)
//   polygon wholly above the horizon (Lambert 1760): E = 1/2 |sum over edges Gamma_i (n . g_i)|, with Gamma_i
//     the angle under which the edge is seen and g_i the unit normal of the plane through edge and point
//
// The renderer adds light samples and BSDF samples weighted by the power heuristic. To see the second kind
// alone, a transparent sheet (mask of opacity 0) stands before the light: it stops shadow rays, and what a
// path finds behind it has weight 1; the sheet is a vertex of its own, hence max_depth 3.
//
// Error rate: 1e-4 for the whole program. Detectable bias of each channel: 0.5 %, of BSDF samples alone 1 %.
#include <array>
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test::direct_area_test {
namespace {

constexpr double kPi = std::numbers::pi;
const char* const kBands = "400-410, 500-510, 690-710";
const Knots kRadiance{{{400, 5}, {500, 1}, {600, 2}, {800, 3}}};
const Knots kReflectance{{{400, 0.2}, {600, 0.9}, {800, 0.5}}};

using Vec = std::array<double, 3>;
double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vec& a) {
  return std::sqrt(dot(a, a));
}
std::string xyz(const Vec& a) {
  return point(a[0], a[1], a[2]);
}

/// A light and the irradiance at the origin that its radiance 1 causes.
struct Light {
  std::string name;
  std::string shape;
  double irradiance;
};

std::string emission() {
  return emitter("area", kRadiance.text("radiance"));
}

Light sphere(const std::string& name, const Vec& centre, double radius) {
  const double d = length(centre);
  return {name, shape("sphere", number("point", "center", xyz(centre)) + real("radius", radius) + emission()),
          kPi * radius * radius / (d * d) * (centre[1] / d)};
}

/// The disk faces down. Rotated by +90 degrees about x its normal +Z becomes -Y.
Light disk(const std::string& name, double lateral, double height, double radius) {
  const double a2 = lateral * lateral, h2 = height * height, r2 = radius * radius;
  const double root = std::sqrt((a2 + h2 + r2) * (a2 + h2 + r2) - 4 * a2 * r2);
  return {
      name,
      shape("disk", to_world(scale(radius, radius, radius) + turn("x", 90) + translate(lateral, height, 0)) +
                        emission()),
      kPi / 2 * (1 - (a2 + h2 - r2) / root)};
}

double polygon_irradiance(const std::vector<Vec>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec& p = corners[i];
    const Vec& q = corners[(i + 1) % corners.size()];
    const Vec normal = cross(p, q);
    sum += std::atan2(length(normal), dot(p, q)) * normal[1] / length(normal);
  }
  return std::abs(sum) / 2;
}

/// Half sides a and b, facing down, then turned about z by `tilt` degrees and moved.
Light rectangle(const std::string& name, double a, double b, double tilt, const Vec& centre) {
  const double angle = tilt * kPi / 180;
  std::vector<Vec> corners;
  for (const auto& [x, z] : {std::pair{-a, -b}, {a, -b}, {a, b}, {-a, b}}) {
    corners.push_back({x * std::cos(angle) + centre[0], x * std::sin(angle) + centre[1], z + centre[2]});
  }
  return {
      name,
      shape("rectangle",
            to_world(scale(a, b, 1) + turn("x", 90) + turn("z", tilt) + translate(xyz(centre))) + emission()),
      polygon_irradiance(corners)};
}

/// The large rectangle below in 9 x 9 parts, which the light tree chooses among: near ones and far ones.
Light tiles() {
  Light whole = rectangle("large near rectangle of tiles", 0.9, 0.9, 0, {0.4, 0.4, 0.1});
  whole.shape.clear();
  for (int i = 0; i < 81; ++i)
    whole.shape += rectangle("", 0.1, 0.1, 0, {-0.4 + 0.2 * (i % 9), 0.4, -0.7 + 0.2 * (i / 9)}).shape;
  return whole;
}

/// Spheres in 44 directions, from 0.5 to 1.7 m away; none before another or before the camera.
Light swarm() {
  Light all{"swarm", "", 0};
  for (int i = 0; i < 44; ++i) {
    const double up = 0.15 + 0.018 * i, away = 0.5 + 0.15 * (i % 9), across = std::sqrt(1 - up * up);
    const Light one =
        sphere("", {away * across * std::cos(2.4 * i), away * up, away * across * std::sin(2.4 * i)}, 0.03);
    all.shape += one.shape;
    all.irradiance += one.irradiance;
  }
  return all;
}

std::vector<Light> lights() {
  return {sphere("sphere overhead", {0, 2, 0}, 0.5),
          sphere("sphere aside", {1.5, 1.2, -0.8}, 0.7),
          sphere("small sphere", {-1, 1, 0.5}, 0.01),
          sphere("sphere at the horizon", {0.8, 0.42, 0.6}, 0.4),
          disk("disk on axis", 0, 1.3, 0.8),
          disk("disk off axis", 1.4, 0.9, 0.6),
          disk("large near disk", 0.5, 0.4, 3),
          rectangle("rectangle overhead", 0.5, 0.3, 0, {0, 1, 0}),
          rectangle("rectangle aside", 0.5, 0.3, 0, {1.2, 0.8, -0.7}),
          rectangle("tilted rectangle", 0.4, 0.6, -35, {-1, 1.1, 0.4}),
          rectangle("large near rectangle", 3, 2, 0, {0.4, 0.4, 0.1}),
          tiles(),
          swarm()};
}

/// The camera's ray ends at the origin from a direction in which no light of lights() stands.
std::string receiver() {
  return shape("rectangle", to_world(turn("x", -90)) + bsdf("diffuse", kReflectance.text("reflectance")));
}

/// Cameras start below large lights: at 0.29 m height.
std::string camera() {
  return perspective(lookat("0.02, 0.29, -0.7", "0, 0, 0"), 0.05, film(8));
}

std::vector<double> reflected(const RenderResult& result, double irradiance) {
  return channel_integrals([=](double nm) { return kRadiance(nm) * kReflectance(nm) * irradiance / kPi; },
                           result);
}

class DirectAreaTest : public ::testing::TestWithParam<Mode> {};

TEST_P(DirectAreaTest, ClosedForms) {
  for (const Light& light : lights()) {
    SCOPED_TRACE(light.name);
    const uint64_t samples = GetParam().sampler == SamplerType::kSobol ? 48 : 224;
    const RenderResult result =
        render_valid(scene(2, camera() + receiver() + light.shape), kBands, GetParam(), {samples, 11});
    expect_image_mean(result, reflected(result, light.irradiance), 0.005);
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, DirectAreaTest, ::testing::ValuesIn(all_modes()), mode_name);

/// Transparent sheets a little before the large lights; paths reach the light by BSDF samples only.
TEST(DirectArea, BsdfSamplesAlone) {
  const std::string sheet_bsdf = bsdf("mask", spectrum("opacity", 0) + bsdf("diffuse", ""));
  const std::string sheet =
      shape("rectangle", to_world(scale(50, 50, 1) + turn("x", 90) + translate(0, 0.35, 0)) + sheet_bsdf);
  for (const Light& light : lights()) {
    if (light.name.find("large") == std::string::npos && light.name.find("on axis") == std::string::npos)
      continue;
    SCOPED_TRACE(light.name);
    const RenderResult result =
        render_valid(scene(3, camera() + receiver() + sheet + light.shape), kBands, {}, {64, 12});
    expect_image_mean(result, reflected(result, light.irradiance), 0.01);
  }
}

/// Emission leaves on the side of the normal only: turned away, the light gives exactly nothing;
/// flip_normals turns back.
TEST(DirectArea, LightsShineOnTheSideOfTheirNormal) {
  const std::string up = turn("x", -90) + translate(0, 1, 0);
  const std::string flip = yes("flip_normals");
  for (const char* type : {"rectangle", "disk"}) {
    SCOPED_TRACE(type);
    const std::string rest = camera() + receiver();
    const RenderResult dark =
        render_valid(scene(2, rest + shape(type, to_world(up) + emission())), kBands, {}, {4, 13});
    expect_exactly(dark, {0, 0, 0});
    const RenderResult bright =
        render_valid(scene(2, rest + shape(type, to_world(up) + flip + emission())), kBands, {}, {64, 13});
    const double irradiance = std::string(type) == "disk"
                                  ? kPi / 2
                                  : polygon_irradiance({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}});
    expect_image_mean(bright, reflected(bright, irradiance), 0.005);
  }
}

/// Two lights together give the sum, whatever their shares of the light samples. Their spectra are disjoint.
TEST(DirectArea, SeveralLightsAddUp) {
  const Knots red{{{600, 0}, {650, 4}, {900, 4}}}, blue{{{300, 50}, {450, 50}, {480, 0}}};
  const std::string ball = shape("sphere", number("point", "center", "0.9, 1.2, 0.3") + real("radius", 0.4) +
                                               emitter("area", red.text("radiance")));
  const std::string plate =
      shape("rectangle", to_world(scale(0.2, 0.2, 1) + turn("x", 90) + translate(-0.5, 1.5, 0)) +
                             emitter("area", blue.text("radiance")));
  const double from_ball = sphere("", {0.9, 1.2, 0.3}, 0.4).irradiance;
  const double from_plate = rectangle("", 0.2, 0.2, 0, {-0.5, 1.5, 0}).irradiance;
  const RenderResult result = render_valid(scene(2, camera() + receiver() + ball + plate),
                                           "400-410, 500-510, 690-710", {}, {256, 14});
  const auto expected = channel_integrals(
      [&](double nm) { return kReflectance(nm) / kPi * (red(nm) * from_ball + blue(nm) * from_plate); },
      result);
  expect_image_mean(result, expected, 0.005);
}

}  // namespace
}  // namespace kiloband::test::direct_area_test
