// The emissivity of rough aluminium against its directional-hemispherical reflectance, which is computed here
// on its own: for light from v, with m the facet's normal,
//   E = int D(m) G1(v) max(v.m, 0) / v.z G1(o) dm,   rho = F-weighted E (1 + F0 (1 - E) / E),   eps = 1 - rho
// by the midpoint rule over the hemisphere of normals in double (furnace_rough_test.cpp has the formulas of D
// and G1), with Fresnel's formulas as complex amplitudes. A plate of 300 K in the void (0 K) shows eps B.
//
// Emissivities are tables of directions, good to 1e-3 of themselves; the test asks for that, beside 5
// standard errors of at most 3e-4. Mirrors, compared with 1: detectable bias 0.3 %.
#include <cmath>
#include <numbers>

#include "spectral/planck.hpp"
#include "tests/statistical/analytic/analytic_test.hpp"
#include "tests/statistical/analytic/fresnel_exact.hpp"

namespace kiloband::test::thermal_emissivity_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPhi = 0.5;  // azimuth of the view

struct Plate {
  bool ggx;
  double alpha_u, alpha_v;
};
struct Direction {
  double x, y, z;
};

double masking(const Plate& p, const Direction& v) {
  const double x = std::abs(v.z) / std::hypot(p.alpha_u * v.x, p.alpha_v * v.y);
  const double lambda = p.ggx ? (std::sqrt(1 + 1 / (x * x)) - 1) / 2
                              : (std::erf(x) - 1) / 2 + std::exp(-x * x) / (2 * x * std::sqrt(kPi));
  return 1 / (1 + lambda);
}

double density(const Plate& p, const Direction& m) {
  const double slope2 =
      (m.x * m.x / (p.alpha_u * p.alpha_u) + m.y * m.y / (p.alpha_v * p.alpha_v)) / (m.z * m.z);
  const double norm = kPi * p.alpha_u * p.alpha_v * std::pow(m.z, 4);
  return p.ggx ? 1 / (norm * (1 + slope2) * (1 + slope2)) : std::exp(-slope2) / norm;
}

double emissivity(const Plate& p, double theta, std::complex<double> index) {
  if (p.alpha_u == 0) return 1 - fresnel_reflectance(std::cos(theta), index);
  constexpr int kRings = 1200, kSpokes = 240;
  const Direction v{std::sin(theta) * std::cos(kPhi), std::sin(theta) * std::sin(kPhi), std::cos(theta)};
  double albedo = 0, reflected = 0;
  for (int r = 0; r < kRings; ++r) {
    const double polar = (r + 0.5) / kRings * kPi / 2;
    for (int s = 0; s < kSpokes; ++s) {
      const double azimuth = (s + 0.5) / kSpokes * 2 * kPi;
      const Direction m{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                        std::cos(polar)};
      const double c = v.x * m.x + v.y * m.y + v.z * m.z;
      const Direction o{2 * c * m.x - v.x, 2 * c * m.y - v.y, 2 * c * m.z - v.z};
      if (c <= 0 || o.z <= 0) continue;
      const double weight = density(p, m) * masking(p, v) * c / v.z * masking(p, o) * std::sin(polar);
      albedo += weight;
      reflected += weight * fresnel_reflectance(c, index);
    }
  }
  const double cell = (kPi / 2 / kRings) * (2 * kPi / kSpokes);
  albedo *= cell, reflected *= cell;
  return 1 - reflected * (1 + fresnel_reflectance(1, index) * (1 - albedo) / albedo);
}

std::string material(const Plate& p, double n, double k) {
  const std::string index = spectrum("eta", n) + spectrum("k", k);
  if (p.alpha_u == 0) return bsdf("conductor", index);
  const std::string alpha = p.alpha_u == p.alpha_v ? real("alpha", p.alpha_u)
                                                   : real("alpha_u", p.alpha_u) + real("alpha_v", p.alpha_v);
  return bsdf("roughconductor", std::string("<string name=\"distribution\" value=\"") +
                                    (p.ggx ? "ggx" : "beckmann") + "\"/>" + alpha + index);
}

std::string view(double theta, const std::string& rest) {
  const std::string eye =
      point(5 * std::sin(theta) * std::cos(kPhi), 5 * std::sin(theta) * std::sin(kPhi), 5 * std::cos(theta));
  return scene(-1, perspective(lookat(eye, "0, 0, 0", "0.1, 0.2, 0.9"), 0.01, film(4)) + rest);
}

/// A plate of 300 K from several directions: its tables of emissivities are computed once.
class Views {
 public:
  Views(const std::string& bsdf_text, const std::string& bands, const Effort& effort,
        const std::string& more = "")
      : rest_(shape("rectangle", to_world(scale("10, 10, 1")) + bsdf_text + thermal(300)) + more),
        effort_(effort),
        prepared_(spec_of(view(0, rest_), bands, {}, effort, ".")) {}

  RenderResult seen(double theta) {
    prepared_.look_as(view(theta, rest_));
    return render_valid(prepared_, effort_);
  }

 private:
  std::string rest_;
  Effort effort_;
  PreparedRender prepared_;
};

/// n, k of aluminium at 10 um (Rakic 1995: 25, 90) and in the visible (0.96, 6.7). Far below 1 at 10 um,
/// where plain single scattering would make it emit 26 times too much at roughness 0.5.
TEST(Emissivity, RoughAluminiumEmitsWhatItDoesNotReflect) {
  const Plate plates[] = {{true, 0, 0},     {true, 0.1, 0.1},   {false, 0.3, 0.3},
                          {true, 0.5, 0.5}, {false, 0.15, 0.5}, {true, 0.4, 0.1}};
  struct {
    double n, k;
  } const metals[] = {{25, 90}, {0.96, 6.7}};
  for (const auto& metal : metals) {
    for (const Plate& plate : plates) {
      Views views(material(plate, metal.n, metal.k), "10000-10050", {64, 61});
      for (const double degrees : {5.0, 45.0, 75.0, 85.0}) {
        SCOPED_TRACE(std::to_string(plate.alpha_u) + " x " + std::to_string(plate.alpha_v) + " at " +
                     std::to_string(degrees));
        const double theta = degrees * kPi / 180;
        const RenderResult result = views.seen(theta);
        const double expected = emissivity(plate, theta, {metal.n, -metal.k});
        EXPECT_GT(expected, 0.005);
        const double shown = result.image_mean[0] / planck_integral(10000, 10050, 300);
        // Directions between nodes are interpolated: 1e-3 of the emissivity, 1e-4 at most.
        EXPECT_NEAR(shown, expected,
                    std::min(1e-3 * expected, 1e-4) + 5 * std::sqrt(result.image_variance[0]));
        EXPECT_LT(std::sqrt(result.image_variance[0]), 3e-4 * result.image_mean[0]);
      }
    }
  }
}

/// Facets that reflect everything: nothing is left to emit, to the precision of the compensation tables. A
/// rough mirror of 300 K under a black sky of 300 K that shows more or less than B would have gained
/// or lost energy: 1e-3.
TEST(Emissivity, RoughMirrorsReflectEverything) {
  for (const Plate& plate : {Plate{true, 0.1, 0.1}, Plate{false, 0.5, 0.5}, Plate{true, 0.2, 0.6}}) {
    Views views(material(plate, 0, 1), "10000-10001", {256, 62}, sky(1));
    for (const double degrees : {5.0, 60.0, 85.0}) {
      SCOPED_TRACE(std::to_string(plate.alpha_u) + " x " + std::to_string(plate.alpha_v) + " at " +
                   std::to_string(degrees));
      expect_image_mean(views.seen(degrees * kPi / 180), {1.0}, 0.003);
    }
  }
}

}  // namespace
}  // namespace kiloband::test::thermal_emissivity_test
