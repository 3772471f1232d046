// Plumes along straight rays against fine quadrature of the formal solution
//
//   L = L0 exp(-kappa D(S)) + int_0^S kappa c(s) B(T(s)) exp(-kappa D(s)) ds,   D(s) = int_0^s c ds',
//
// in double, on fields that are written down here once more. Nothing is random but the wavelength in channels
// of 0.01 nm. What is allowed is the error that shared/plume.h states, 2e-3 B(T_hot) (1 - exp(-kappa D)), and
// 1e-4 of the value for the columns and single precision.
#include "shared/plume.h"

#include <cmath>
#include <functional>
#include <sstream>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/gas/gas_scenes.hpp"

namespace kiloband::test::plume_test {
namespace {

struct Point {
  double temperature_k, scale;
};
/// Of the distance from the ray's begin, m.
using Field = std::function<Point(double)>;

/// Channels of 0.01 nm: visible, short, middle and long wave infrared.
const char* const kBands = "700-700.01, 2500-2500.01, 4500-4500.01, 10000-10000.01";
constexpr double kLamp = 0.4;

struct Integrated {
  double radiance, depth;
};

/// The formal solution in steps of `metres` / 40000, D by the trapezoid rule.
Integrated integrate(const Field& field, double metres, double kappa, double lambda_nm) {
  constexpr int kSteps = 40000;
  const double h = metres / kSteps;
  double depth = 0, radiance = 0;
  Point before = field(0);
  for (int i = 1; i <= kSteps; ++i) {
    const Point here = field(i * h), middle = field((i - 0.5) * h);
    const double step = kappa * h * (before.scale + 4 * middle.scale + here.scale) / 6;
    radiance += std::exp(-depth - 0.5 * step) * 2 * std::sinh(0.5 * step) *
                planck_radiance(lambda_nm, middle.temperature_k);
    depth += step;
    before = here;
  }
  return {radiance + kLamp * std::exp(-depth), depth};
}

void expect_plume(const std::string& xml, const Field& field, double metres, double kappa, double hottest_k,
                  const std::filesystem::path& folder = ".") {
  for (const Mode& mode : {Mode{}, Mode{WavelengthMode::kPerPath, SamplerType::kSobol}}) {
    SCOPED_TRACE(name_of(mode));
    const RenderResult result = render_valid(xml, kBands, mode, {2, 51}, folder);
    for (std::size_t c = 0; c < result.channels; ++c) {
      const Channel& channel = result.scene.channels[c];
      const Integrated exact = integrate(field, metres, kappa, channel.centre_nm());
      const double hot = planck_radiance(channel.centre_nm(), hottest_k);
      const double allowed = KB_PLUME_TOLERANCE * hot * -std::expm1(-exact.depth) + 1e-4 * exact.radiance;
      EXPECT_NEAR(result.at(0, 0, c) / channel.width_nm(), exact.radiance, allowed)
          << channel.min_nm << " nm, optical depth " << exact.depth;
    }
  }
}

std::string view(const std::string& origin, const std::string& target) {
  return perspective(lookat(origin, target, "0.1, 1, 0.2"), 1e-4, film(1));
}

struct Ray {
  double from[3], to[3];
};

/// A plume whose state at a point is `field`, in front of the lamp, along a ray.
/// cube: the shape that holds it.
void expect_along(const Ray& ray, Point (*field)(double x, double y, double z), const std::string& cube,
                  double kappa, double hot, const std::filesystem::path& folder = ".") {
  SCOPED_TRACE(kappa);
  const auto& a = ray.from;
  const auto& b = ray.to;
  const double length = std::sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
                                  (b[2] - a[2]) * (b[2] - a[2]));
  const Field along = [&](double s) {
    const double t = s / length;
    return field(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]));
  };
  expect_plume(scene(4, view(point(a[0], a[1], a[2]), point(b[0], b[1], b[2])) + sky(kLamp) + cube), along,
               length, kappa, hot, folder);
}

constexpr double kHot = 1800, kCold = 290, kRadius = 0.3, kSpread = 0.12, kLength = 6;

Point jet(double x, double y, double z) {
  if (z < 0 || z > kLength) return {kCold, 0};
  const double w = kRadius + kSpread * z, c = kRadius / w * std::exp(-(x * x + y * y) / (w * w));
  return {kCold + c * (kHot - kCold), c};
}

std::string jet_medium(double kappa) {
  return medium("plume", "interior",
                spectrum("absorption", kappa) + real("temperature", kHot) + real("ambient", kCold) +
                    real("radius", kRadius) + real("spread", kSpread) + real("length", kLength));
}

/// Across the jet near its nozzle and far from it, and along it, thin to thick.
/// The box is 8 m wide around the jet.
TEST(Plume, JetAgainstFineQuadrature) {
  const Ray rays[] = {
      {{5, 0.1, 0.5}, {-5, 0.1, 0.5}}, {{5, -0.2, 4.5}, {-5, 0.3, 4.2}}, {{0.1, 0.05, 9}, {-0.02, 0, -3}}};
  for (const double kappa : {1e-3, 0.3, 3.0, 300.0}) {
    const std::string cube =
        shape("cube", to_world(scale("4") + step("translate", "z='3'")) + kNull + jet_medium(kappa));
    for (const Ray& ray : rays) expect_along(ray, jet, cube, kappa, kHot);
  }
}

/// A lattice with no symmetry: 5 x 4 x 6 nodes over [-1, 1]^3.
constexpr int kNodes[3] = {5, 4, 6};

Point node(int i, int j, int k) {
  return {400.0 + 150 * i + 90 * j * (k % 3) + 60 * ((i + k) % 4), ((i * 7 + j * 5 + k * 3) % 8) / 4.0};
}

Point lattice(double x, double y, double z) {
  const double p[3] = {(x + 1) / 2 * (kNodes[0] - 1), (y + 1) / 2 * (kNodes[1] - 1),
                       (z + 1) / 2 * (kNodes[2] - 1)};
  int cell[3];
  double f[3];
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < 0 || p[axis] > kNodes[axis] - 1) return {300, 0};
    cell[axis] = std::min(static_cast<int>(p[axis]), kNodes[axis] - 2);
    f[axis] = p[axis] - cell[axis];
  }
  Point sum{0, 0};
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    int at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = corner >> axis & 1;
      weight *= bit ? f[axis] : 1 - f[axis];
      at[axis] = cell[axis] + bit;
    }
    const Point n = node(at[0], at[1], at[2]);
    sum.temperature_k += weight * n.temperature_k;
    sum.scale += weight * n.scale;
  }
  return sum;
}

double write_lattice(const TemporaryFolder& folder) {
  std::ostringstream text;
  double hottest = 0;
  text << "temperature scale\n";
  for (int k = 0; k < kNodes[2]; ++k)
    for (int j = 0; j < kNodes[1]; ++j)
      for (int i = 0; i < kNodes[0]; ++i) {
        const Point n = node(i, j, k);
        text << n.temperature_k << " " << n.scale << "\n";
        hottest = std::max(hottest, n.temperature_k);
      }
  folder.write("plume.txt", text.str());
  return hottest;
}

TEST(Plume, GridAgainstFineQuadrature) {
  const TemporaryFolder folder;
  const double hottest = write_lattice(folder);
  const Ray rays[] = {{{3, 0.1, 0.2}, {-3, -0.2, 0.3}},
                      {{0.3, 4, -0.5}, {-0.4, -4, 0.9}},
                      {{2, 3, 4}, {-2, -2.9, -4.2}},
                      {{0.5, -0.2, 3}, {0.5, -0.2, -3}}};
  for (const double kappa : {1e-3, 0.5, 50.0}) {
    const std::string cube =
        shape("cube", to_world(scale("1.5")) + kNull +
                          medium("plume", "interior",
                                 spectrum("absorption", kappa) + text("field", "grid") +
                                     text("nodes", "5, 4, 6") + text("filename", "plume.txt") +
                                     to_world(step("translate", "x='-0.5' y='-0.5' z='-0.5'") + scale("2"))));
    for (const Ray& ray : rays) expect_along(ray, lattice, cube, kappa, hottest, folder.path());
  }
}

/// Light samples through a plume take its whole column: a point light across the jet.
TEST(Plume, ShadowRayTakesTheColumn) {
  constexpr double kKappa = 0.8;
  const std::string plane =
      shape("rectangle", to_world(turn("y", "90") + step("translate", "x='-3' z='2'")) + diffuse(0.5));
  // So cold that it emits nothing here.
  const std::string cold =
      medium("plume", "interior",
             spectrum("absorption", kKappa) + real("temperature", 2) + real("ambient", 1) +
                 real("radius", kRadius) + real("spread", kSpread) + real("length", kLength));
  const std::string box =
      shape("cube",
            to_world(step("scale", "x='2' y='4' z='4'") + step("translate", "x='0.5' z='3'")) + kNull + cold);
  const std::string light =
      emitter("point", spectrum("intensity", 1) + number("point", "position", "4, 0.1, 2"));
  const std::string camera = view("-2, 0.1, 2", "-3, 0.1, 2");
  const RenderResult result = render_valid(scene(2, camera + plane + light + box), "500-500.01", {}, {2, 52});
  const Integrated along = integrate(
      [](double s) {
        return jet(4 - s, 0.1, 2).scale > 0 ? Point{1, jet(4 - s, 0.1, 2).scale} : Point{1, 0};
      },
      7, kKappa, 500);
  const double expected = 0.01 * 0.5 / std::numbers::pi / 49 * std::exp(-along.depth);
  EXPECT_NEAR(result.at(0, 0, 0), expected, 1e-4 * expected);
}

}  // namespace
}  // namespace kiloband::test::plume_test
