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

/// The column of a ray from `from` towards `to` through a jet: by shared/plume.h, by steps and by cells, against Simpson's
/// rule in double with steps of a 400th of the jet's scale where they are.
void expect_column(double radius, double spread, const Ray& ray) {
  SCOPED_TRACE("radius " + std::to_string(radius) + " spread " + std::to_string(spread));
  KbMedium m{};
  m.type = KB_MEDIUM_JET;
  m.scale = 1;
  m.temperature_k = m.reference_k = 1800;
  m.ambient_k = 290;
  m.radius = static_cast<float>(radius);
  m.spread = static_cast<float>(spread);
  m.length = 10;
  m.to_local[0] = m.to_local[5] = m.to_local[10] = 1;
  for (float& x : m.second) x = 4;
  const glm::dvec3 from(ray.from[0], ray.from[1], ray.from[2]), to(ray.to[0], ray.to[1], ray.to[2]);
  const glm::dvec3 d = glm::normalize(to - from);
  const KbFloat3 origin{float(from.x), float(from.y), float(from.z)},
      direction{float(d.x), float(d.y), float(d.z)};
  KbPlumeWalk walk;
  ASSERT_TRUE(kb_plume_begin(&walk, &m, nullptr, origin, direction, 0, float(glm::length(to - from))));
  double cells = 0, exact = 0;
  KbPlumeWalk again = walk;
  KbPlumeCell cell[2];
  while (const kb_u32 count = kb_plume_next(&again, &m, nullptr, cell))
    for (kb_u32 i = 0; i < count; ++i) cells += cell[i].column;
  const auto excess = [&](double s) {
    const double x = origin.x + s * direction.x, y = origin.y + s * direction.y,
                 w = m.radius + m.spread * (origin.z + s * double{direction.z});
    return m.radius / w * std::exp(-(x * x + y * y) / (w * w));
  };
  for (double s = walk.at; s < walk.end;) {
    const double w = m.radius + m.spread * (origin.z + s * double{direction.z});
    const double h = std::min(w / (1 + m.spread) / 400, walk.end - s);
    exact += h / 6 * (excess(s) + 4 * excess(s + 0.5 * h) + excess(s + h));
    if (!(s + h > s)) break;
    s += h;
  }
  EXPECT_NEAR(kb_plume_column(&walk, &m, nullptr) / exact, 1, 2e-5);
  EXPECT_NEAR(cells / exact, 1, 2e-5);
}

/// From a nozzle on a jet widens `spread` times as fast as it goes on: along the axis, where it is narrow, it changes on
/// radius / spread, however long the way.
TEST(Plume, ColumnsOfJetsThatWiden) {
  for (const auto& [radius, spread] : {std::pair{0.3, 0.12},
                                       {1.0, 1.0},
                                       {0.03, 1.0},
                                       {1.0, 3.0},
                                       {0.1, 10.0},
                                       {1.0, 100.0},
                                       {1.0, 1000.0},
                                       {0.001, 0.1}}) {
    expect_column(radius, spread, {{0, 0, 11}, {0, 0, 0}});
    expect_column(radius, spread, {{0, 0, 0}, {0, 0, 12}});
    const double far = radius + 10 * spread;
    expect_column(radius, spread, {{radius, 0.3 * radius, 0}, {0.5 * far, -0.4 * far, 10}});
    expect_column(radius, spread, {{-far, 0.2 * far, 5}, {far, 0.1 * far, 4}});
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
