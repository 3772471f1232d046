// Albedos of microfacet lobes and the tables made of them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scene/optics/compensation.hpp"
#include "scene/optics/facet_quadrature.hpp"
#include "shared/thermal.h"
#include "tests/support/one_path_bsdfs.hpp"

namespace kiloband::test {

namespace {

glm::dvec3 direction(double degrees, double phi) {
  const double theta = degrees * M_PI / 180;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

std::vector<Facets> facets() {
  return {{false, 0.1, 0.1}, {true, 0.1, 0.1},   {false, 0.5, 0.5},
          {true, 0.8, 0.8},  {false, 0.15, 0.5}, {true, 0.4, 0.1}};
}

std::string label(const Facets& f, double degrees) {
  return (f.ggx ? "ggx " : "beckmann ") + std::to_string(f.alpha_u) + " x " + std::to_string(f.alpha_v) +
         ", " + std::to_string(degrees) + " degrees";
}

TEST(VisibleFacets, WeightsSumToOne) {
  for (const Facets& f : facets()) {
    for (const double degrees : {0.0, 30.0, 80.0, 89.9, 90.0}) {
      double sum = 0;
      for (const VisibleFacet& facet : visible_facets(f, direction(degrees, 0.7))) sum += facet.weight;
      EXPECT_NEAR(sum, 1, 1e-6) << label(f, degrees);
    }
  }
}

/// The definition: int D(m) G1(v) max(v.m, 0) / v.z G1(o) dm by the midpoint rule over the hemisphere of
/// normals, D of Walter et al. 2007 written down once more; the rule's own error is below 5e-5 here.
double brute_force(const Facets& f, const glm::dvec3& v, double eta) {
  constexpr int kRings = 3000, kSpokes = 360;
  double sum = 0;
  for (int r = 0; r < kRings; ++r) {
    const double polar = (r + 0.5) / kRings * M_PI / 2;
    for (int s = 0; s < kSpokes; ++s) {
      const double azimuth = (s + 0.5) / kSpokes * 2 * M_PI;
      const glm::dvec3 m(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                         std::cos(polar));
      const double c = glm::dot(v, m);
      if (c <= 0) continue;
      const double t2 = (std::pow(m.x / f.alpha_u, 2) + std::pow(m.y / f.alpha_v, 2)) / (m.z * m.z);
      const double norm = M_PI * f.alpha_u * f.alpha_v * std::pow(m.z, 4);
      const double d = f.ggx ? 1 / (norm * (1 + t2) * (1 + t2)) : std::exp(-t2) / norm;
      const double reflectance = eta == 1 ? 1 : dielectric_reflectance(c, eta);
      double kept = reflectance * f.masking(2 * c * m - v);
      if (reflectance < 1) {
        const double cos_t = std::sqrt(1 - (1 - c * c) / (eta * eta));
        const glm::dvec3 t = (c / eta - cos_t) * m - v / eta;
        kept += (1 - reflectance) * f.masking({t.x, t.y, -t.z});
      }
      sum += d * f.masking_over_cos(v) * c * kept * std::sin(polar);
    }
  }
  return sum * (M_PI / 2 / kRings) * (2 * M_PI / kSpokes);
}

TEST(VisibleFacets, AlbedosAreThoseOfTheDefinition) {
  for (const Facets& f : facets()) {
    for (const double degrees : {20.0, 75.0}) {
      const glm::dvec3 v = direction(degrees, 0.7);
      EXPECT_NEAR(mirror_albedo(f, v), brute_force(f, v, 1), 1e-4) << label(f, degrees);
      for (const double eta : {1.5, 1 / 1.5}) {
        const Albedo albedo = boundary_albedo(f, v, eta);
        EXPECT_NEAR(albedo.reflected + albedo.transmitted, brute_force(f, v, eta), 1e-4)
            << label(f, degrees) << ", eta " << eta;
      }
    }
  }
}

KbMaterial material(uint32_t type, const Facets& f) {
  KbMaterial m{};
  m.type = type;
  m.flags = KB_MATERIAL_COMPENSATED | KB_MATERIAL_SAMPLE_VISIBLE;
  if (f.ggx) m.flags |= KB_MATERIAL_GGX;
  m.alpha_u = static_cast<float>(f.alpha_u);
  m.alpha_v = static_cast<float>(f.alpha_v);
  m.eta = 1.5f;
  return m;
}

/// What compensation.hpp states, with its own quadrature error.
double table_bound(const KbMaterial& m, bool below) {
  const bool glass = m.type == KB_MATERIAL_ROUGH_DIELECTRIC;
  if (m.alpha_u != m.alpha_v) return glass ? 1.5e-3 : 2e-4;
  return below ? 3e-4 : 1e-4;
}

/// What the renderer looks up, at random directions of both sides.
TEST(Compensation, TablesFollowTheAlbedo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const Facets& f : facets()) {
    for (const uint32_t type : {KB_MATERIAL_ROUGH_CONDUCTOR, KB_MATERIAL_ROUGH_DIELECTRIC}) {
      const KbMaterial m = material(type, f);
      const Facets stored(m);
      const std::vector<float> table = make_compensation_table(m, {1.5, 1.5});
      const MaterialContext context{&m, nullptr, {}, table.data()};
      for (int i = 0; i < 40; ++i) {
        const double cosine = i % 2 ? uniform(random) : std::pow(uniform(random), 4);
        const glm::dvec3 v = direction(std::acos(cosine) * 180 / M_PI, 2 * M_PI * uniform(random));
        const bool below = type == KB_MATERIAL_ROUGH_DIELECTRIC && i % 4 < 2;
        double expected = mirror_albedo(stored, v);
        if (type == KB_MATERIAL_ROUGH_DIELECTRIC) {
          const Albedo albedo = boundary_albedo(stored, v, below ? 1 / 1.5 : 1.5);
          expected = albedo.reflected + albedo.transmitted;
        }
        const glm::vec3 wi(v.x, v.y, below ? -v.z : v.z);
        EXPECT_NEAR(lobe_albedo(context, wi), expected, table_bound(m, below))
            << label(f, std::acos(cosine) * 180 / M_PI);
      }
    }
  }
}

/// R / E between the nodes, from the smoothest boundary on, to what compensation.hpp states; at random directions, and close
/// to grazing and to the critical angle.
TEST(ReflectedPart, TablesFollowTheAlbedo) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double alpha : {1e-4, 1e-3, 0.01, 0.1, 1.0}) {
    for (const uint32_t type : {KB_MATERIAL_ROUGH_PLASTIC, KB_MATERIAL_ROUGH_DIELECTRIC}) {
      const KbMaterial m = material(type, {true, alpha, alpha});
      const Facets stored(m);
      const std::vector<float> table = make_reflected_part(m);
      const bool glass = type == KB_MATERIAL_ROUGH_DIELECTRIC;
      ASSERT_EQ(table.size(), (glass ? 2u : 1u) * KB_COMPENSATION_NODES);
      for (int i = 0; i < 60; ++i) {
        const bool below = glass && i % 2;
        const double eta = below ? 1 / 1.5 : 1.5, edge = below ? std::sqrt(1 - eta * eta) : 0;
        const double u = uniform(random), near = edge + (i % 4 < 2 ? 1 - edge : -edge) * u * u * u;
        const double cosine = i % 3 ? std::clamp(near, 0.01, 1.0) : std::max(0.01, u);
        const glm::dvec3 v(std::sqrt(1 - cosine * cosine), 0, cosine);
        const Albedo albedo = boundary_albedo(stored, v, eta);
        const double all = glass ? albedo.reflected + albedo.transmitted : mirror_albedo(stored, v);
        const float* const nodes = &table[below ? KB_COMPENSATION_NODES : 0];
        const float x = kb_reflected_position(static_cast<float>(cosine), static_cast<float>(eta)) *
                        (KB_COMPENSATION_NODES - 1);
        const auto node = std::min(static_cast<std::size_t>(x), std::size_t{KB_COMPENSATION_NODES - 2});
        const double t = x - static_cast<float>(node);
        const double bound = !below ? 7e-5 : std::abs(cosine - edge) < 1e-3 ? 6e-3 : 7e-4;
        EXPECT_NEAR((1 - t) * nodes[node] + t * nodes[node + 1], albedo.reflected / all, bound)
            << "alpha " << alpha << ", eta " << eta << ", cosine " << cosine;
      }
    }
  }
}

/// A dispersive boundary: between the nodes of the index.
TEST(Compensation, TablesFollowTheIndex) {
  KbMaterial m = material(KB_MATERIAL_ROUGH_DIELECTRIC, {true, 0.3, 0.3});
  m.flags |= KB_MATERIAL_DISPERSIVE;
  const Facets stored(m);
  const std::vector<float> table = make_compensation_table(m, {1.4, 1.9});
  for (const float eta : {1.4f, 1.47f, 1.6f, 1.9f}) {
    const MaterialContext context{&m, nullptr, {eta}, table.data()};
    const Albedo albedo = boundary_albedo(stored, direction(50, 0), eta);
    EXPECT_NEAR(lobe_albedo(context, glm::vec3(direction(50, 0))), albedo.reflected + albedo.transmitted,
                2e-4)
        << eta;
  }
}

/// With F = 1 everything is reflected: the compensated lobe integrates
/// to 1 (by its own samples: weights average to 1).
TEST(Compensation, NothingIsLost) {
  const Facets f(true, 0.4, 0.4);
  KbMaterial m = material(KB_MATERIAL_ROUGH_CONDUCTOR, f);
  m.flags |= KB_MATERIAL_PERFECT_MIRROR;
  m.bound_a = 1;
  const std::vector<float> table = make_compensation_table(m, {1, 1});
  const MaterialContext context{&m, nullptr, {}, table.data()};
  constexpr int kSide = 400;  // a lattice of random numbers: no noise beyond 1e-4
  for (const double degrees : {10.0, 60.0, 85.0}) {
    double sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const glm::vec2 u((i % kSide + 0.5f) / kSide, (i / kSide + 0.5f) / kSide);
      const BsdfSample sample = sample_bsdf(context, glm::vec3(direction(degrees, 0.3)), 0.5f, u);
      if (sample.pdf > 0) sum += sample.w0;
    }
    EXPECT_NEAR(sum / (kSide * kSide), 1, 5e-4) << degrees;
  }
}

}  // namespace
}  // namespace kiloband::test
