// Furnaces for rough materials: what a plane under a sky of radiance 1 shows is the directional albedo.
//
// Single scattering by microfacets of density D with Smith's separable masking. Facets are visible from i
// with density D(m) G1(i) max(i.m, 0) / cos_i (it integrates to 1), so with F on the facet
//     albedo = int D(m) G1(i) max(i.m, 0) / cos_i [ F G1(o_r) + (1 - F) G1(o_t) / eta^2 ] dm
// where o_r is mirrored, o_t refracted at m; G1 = 0 for directions on the wrong side of the plane. The second
// term is for dielectrics: radiance that comes out of the denser side is divided by eta^2.
// Integrated here in double, with
//     Beckmann  D = exp(-tan^2 / a^2) / (pi a^2 cos^4),  L = (erf(x) - 1) / 2 + exp(-x^2) / (2 x sqrt(pi)),
//     GGX       D = a^2 / (pi cos^4 (a^2 + tan^2)^2),    L = (sqrt(1 + 1 / x^2) - 1) / 2,
//     G1 = 1 / (1 + L),  x = 1 / (a tan theta)
// (Walter et al. 2007, Heitz 2014). Roughness that differs along x and y: directions are stretched, a becomes
// the roughness along their azimuth. Nothing is above 1: what is missing is the energy of multiple
// scattering, at most 2 % at roughness 0.1.
//
// Rough plastic combines tables: its albedo is integrated from eval_bsdf().
// Error rate: 1e-4 for the whole program. Detectable bias: 0.5 %.
#include <cmath>
#include <numbers>

#include "tests/statistical/analytic/analytic_test.hpp"
#include "tests/statistical/analytic/fresnel_exact.hpp"
#include "tests/support/one_path_bsdfs.hpp"

namespace kiloband::test::furnace_rough_test {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPhi = 0.4;  // azimuth of the view
const char* const kBands = "500-501";

std::vector<double> widths(const RenderResult& result, double radiance) {
  return channel_integrals([=](double) { return radiance; }, result);
}

std::string plane_furnace(const std::string& material, double theta) {
  const std::string eye =
      point(5 * std::sin(theta) * std::cos(kPhi), 5 * std::sin(theta) * std::sin(kPhi), 5 * std::cos(theta));
  return scene(-1, perspective(lookat(eye, "0, 0, 0", "0.1, 0.2, 0.9"), 0.05, film(8)) +
                       shape("rectangle", to_world(scale("10, 10, 1")) + material) + sky(1));
}

struct Facets {
  bool ggx = false;
  double alpha_u = 0.1, alpha_v = 0.1;

  std::string text() const {
    return std::string("<string name=\"distribution\" value=\"") + (ggx ? "ggx" : "beckmann") + "\"/>" +
           (alpha_u == alpha_v ? real("alpha", alpha_u)
                               : real("alpha_u", alpha_u) + real("alpha_v", alpha_v));
  }
};

struct Direction {
  double x, y, z;
};
double dot(const Direction& a, const Direction& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

double density(const Facets& f, const Direction& m) {
  const double slope2 =
      (m.x * m.x / (f.alpha_u * f.alpha_u) + m.y * m.y / (f.alpha_v * f.alpha_v)) / (m.z * m.z);
  const double norm = kPi * f.alpha_u * f.alpha_v * std::pow(m.z, 4);
  return f.ggx ? 1 / (norm * (1 + slope2) * (1 + slope2)) : std::exp(-slope2) / norm;
}

double masking(const Facets& f, const Direction& v) {
  const double x = std::abs(v.z) / std::hypot(f.alpha_u * v.x, f.alpha_v * v.y);
  const double lambda = f.ggx ? (std::sqrt(1 + 1 / (x * x)) - 1) / 2
                              : (std::erf(x) - 1) / 2 + std::exp(-x * x) / (2 * x * std::sqrt(kPi));
  return 1 / (1 + lambda);
}

/// The integral above. index: of the other side relative to this one; a dielectric if `transmits`.
double albedo(const Facets& f, double theta, std::complex<double> index, bool transmits) {
  constexpr int kRings = 1500, kSpokes = 240;
  const Direction i{std::sin(theta) * std::cos(kPhi), std::sin(theta) * std::sin(kPhi), std::cos(theta)};
  const double eta = index.real();
  double sum = 0;
  for (int r = 0; r < kRings; ++r) {
    const double polar = (r + 0.5) / kRings * kPi / 2;
    for (int s = 0; s < kSpokes; ++s) {
      const double azimuth = (s + 0.5) / kSpokes * 2 * kPi;
      const Direction m{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                        std::cos(polar)};
      const double c = dot(i, m);
      if (c <= 0) continue;
      const double reflectance = std::min(1.0, fresnel_reflectance(c, index));
      const Direction o{2 * c * m.x - i.x, 2 * c * m.y - i.y, 2 * c * m.z - i.z};
      double scattered = o.z > 0 ? reflectance * masking(f, o) : 0;
      if (transmits && reflectance < 1) {
        const double k = c / eta - std::sqrt(1 - (1 - c * c) / (eta * eta));
        const Direction t{k * m.x - i.x / eta, k * m.y - i.y / eta, k * m.z - i.z / eta};
        if (t.z < 0) scattered += (1 - reflectance) * masking(f, t) / (eta * eta);
      }
      sum += density(f, m) * masking(f, i) * c / i.z * scattered * std::sin(polar);
    }
  }
  return sum * (kPi / 2 / kRings) * (2 * kPi / kSpokes);
}

/// All distributions at roughness 0.1 to 0.6, isotropic and not.
std::vector<Facets> facets() {
  return {{false, 0.1, 0.1}, {true, 0.1, 0.1},   {false, 0.5, 0.5},
          {true, 0.4, 0.4},  {false, 0.15, 0.5}, {true, 0.6, 0.2}};
}

std::string label(const Facets& f, double degrees) {
  return f.text() + " at " + std::to_string(degrees);
}

/// Mirrors without absorption: the loss is masking's alone. Detectable bias: 0.5 %.
TEST(RoughFurnace, PerfectlyConductingFacets) {
  for (const Facets& f : facets()) {
    for (const double degrees : {5.0, 45.0, 80.0}) {
      SCOPED_TRACE(label(f, degrees));
      const double theta = degrees * kPi / 180;
      // |r| = 1 for every angle: an index without real part.
      const double expected = albedo(f, theta, {0, -1}, false);
      EXPECT_LE(expected, 1.0001);
      if (degrees < 80 && f.alpha_u == 0.1 && f.alpha_v == 0.1) {
        EXPECT_GT(expected, 0.98);
      }
      const RenderResult result =
          render_valid(plane_furnace(bsdf("roughconductor", f.text()), theta), kBands, {}, {24, 41});
      expect_image_mean(result, widths(result, expected), 0.005);
      EXPECT_LE(result.image_mean[0], 1 + 5 * std::sqrt(result.image_variance[0]) + kRounding);
    }
  }
}

/// Metals: gold-like and tungsten-like constants, in all modes. Detectable bias: 0.8 %.
class RoughMetalTest : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, RoughMetalTest, ::testing::ValuesIn(all_modes()), mode_name);

TEST_P(RoughMetalTest, AlbedoWithFresnel) {
  struct {
    double n, k;
  } const constants[] = {{0.2, 3.2}, {3.5, 2.8}};
  for (const auto& metal : constants) {
    for (const Facets& f : {facets()[2], facets()[5]}) {
      SCOPED_TRACE(label(f, 60));
      const std::string material =
          bsdf("roughconductor", f.text() + spectrum("eta", metal.n) + spectrum("k", metal.k));
      const RenderResult result =
          render_valid(plane_furnace(material, kPi / 3), kBands, GetParam(), {96, 42});
      expect_image_mean(result, widths(result, albedo(f, kPi / 3, {metal.n, -metal.k}, false)), 0.008);
    }
  }
}

/// A rough glass boundary from outside (eta 1.5) and, with exchanged indices, from inside.
/// Detectable bias: 1 %.
TEST(RoughFurnace, DielectricBoundary) {
  for (const Facets& f : facets()) {
    for (const double eta : {1.5, 1 / 1.5}) {
      for (const double degrees : {20.0, 65.0}) {
        SCOPED_TRACE(label(f, degrees) + " eta " + std::to_string(eta));
        const double theta = degrees * kPi / 180;
        const std::string material = bsdf("roughdielectric", f.text() + real("int_ior", eta > 1 ? 1.5 : 1.0) +
                                                                 real("ext_ior", eta > 1 ? 1.0 : 1.5));
        const RenderResult result = render_valid(plane_furnace(material, theta), kBands, {}, {32, 43});
        expect_image_mean(result, widths(result, albedo(f, theta, eta, true)), 0.01);
      }
    }
  }
}

// ---- rough plastic ----

/// Albedo of material 0 by the midpoint rule over the outgoing hemisphere (finer around the mirror direction
/// is not needed: roughness is 0.2 and more). `a`, `b`: specular and diffuse reflectance.
double plastic_albedo(const FlatScene& flat_scene, double theta, double a, double b) {
  const KbMaterial& material = flat_scene.materials.front();
  const MaterialContext context{&material, &flat_scene.tables[material.table], {}};
  const glm::vec3 wi(std::sin(theta), 0, std::cos(theta));
  constexpr int kRings = 600, kSpokes = 600;
  const double share = material.flags & KB_MATERIAL_NONLINEAR ? b / (1 - b + b * material.escape) : b;
  double sum = 0;
  for (int r = 0; r < kRings; ++r) {
    const double z = (r + 0.5) / kRings, ring = std::sqrt(1 - z * z);
    for (int s = 0; s < kSpokes; ++s) {
      const double azimuth = (s + 0.5) / kSpokes * 2 * kPi;
      const BsdfValue value =
          eval_bsdf(context, wi, glm::vec3(ring * std::cos(azimuth), ring * std::sin(azimuth), z));
      sum += a * value.w0 + share * value.w1;
    }
  }
  return sum * 2 * kPi / kRings / kSpokes;
}

/// Detectable bias: 0.5 %.
TEST(RoughFurnace, RoughPlastic) {
  for (const bool nonlinear : {false, true}) {
    for (const double rho : {1.0, 0.4}) {
      for (const char* distribution : {"beckmann", "ggx"}) {
        for (const double degrees : {15.0, 70.0}) {
          SCOPED_TRACE(std::string(distribution) + " " + std::to_string(rho) + " " + std::to_string(degrees) +
                       (nonlinear ? " nonlinear" : ""));
          const std::string material =
              bsdf("roughplastic",
                   spectrum("diffuse_reflectance", rho) + spectrum("specular_reflectance", 0.9) +
                       real("alpha", 0.25) + "<string name=\"distribution\" value=\"" + distribution +
                       "\"/><boolean name=\"nonlinear\" value=\"" + (nonlinear ? "true" : "false") + "\"/>");
          const RenderResult result =
              render_valid(plane_furnace(material, degrees * kPi / 180), kBands, {}, {32, 44});
          const double expected = plastic_albedo(result.scene, degrees * kPi / 180, 0.9, rho);
          EXPECT_LE(expected, 1);
          expect_image_mean(result, widths(result, expected), 0.005);
        }
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::furnace_rough_test
