// The building blocks: Fresnel's formulas, distributions of normals, rough transmittance.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "reference.hpp"
#include "src_cpu/lanes/one_lane.hpp"
// After the lanes that they are to be compiled for.
#include "src_cpu/bsdf/fresnel-inl.hpp"
#include "src_cpu/bsdf/microfacet-inl.hpp"

namespace kiloband::test::test_microfacet {

using namespace cpu;
namespace {

struct Reflection {
  float reflectance, cos_t;
};

Reflection fresnel_dielectric(float cos_i, float eta) {
  const auto f = one_lane::fresnel_dielectric(cos_i, eta);
  return {f.reflectance.v, f.cos_t.v};
}

constexpr one_lane::M kActive{true};

one_lane::V3 lane_of(glm::vec3 v) {
  return {v.x, v.y, v.z};
}

// Near the critical angle F has an infinite slope, so the formula cannot do better than what half an ulp of
// the cosine makes of it: the error is allowed to be 3e-6 plus the change of F over 2e-7 in cosine.
TEST(Fresnel, MatchesComplexArithmetic) {
  for (float eta : {0.25f, 0.5f, 0.7f, 0.99f, 0.99999f, 1.00001f, 1.01f, 1.33f, 1.5f, 2.4f, 4.0f})
    for (int i = 0; i <= 20000; ++i) {
      const float c = std::max(1e-6f, i / 20000.0f);
      const long double expected = reference::fresnel(c, eta);
      const long double spread = std::abs(reference::fresnel(std::min(1.0f, c + 2e-7f), eta) -
                                          reference::fresnel(std::max(0.0f, c - 2e-7f), eta));
      const Reflection f = fresnel_dielectric(c, eta);
      ASSERT_NEAR(f.reflectance, double(expected), 3e-6 + double(spread)) << "cos " << c << " eta " << eta;
      ASSERT_LE(f.cos_t, 1);
    }
}

TEST(Fresnel, KnownPoints) {
  EXPECT_FLOAT_EQ(fresnel_dielectric(1, 1.5f).reflectance, 0.04f);
  EXPECT_EQ(fresnel_dielectric(0.3f, 1).reflectance, 0);
  EXPECT_EQ(fresnel_dielectric(0, 1.5f).reflectance, 1);
  EXPECT_EQ(fresnel_dielectric(0.5f, 1 / 1.5f).reflectance, 1);  // beyond the critical angle of 41.8 degrees
}

TEST(Microfacet, DensityAndMaskingMatchDouble) {
  Uniform uniform(3);
  for (bool ggx : {false, true})
    for (float alpha : {0.001f, 0.05f, 0.3f, 1.0f}) {
      const one_lane::Facets facets{alpha, 0.5f * alpha, {ggx}, {true}};
      const reference::Roughness r{ggx, alpha, 0.5 * alpha};
      for (int i = 0; i < 2000; ++i) {
        const glm::vec3 v = direction(89.9 * uniform(), 6 * uniform());
        const double g = reference::masking(r, glm::dvec3(v));
        const one_lane::V3 w = lane_of(v);
        ASSERT_NEAR(facet_masking(facets, w, kActive).v, g, 2e-6);
        ASSERT_NEAR(facet_masking_over_cos(facets, w, kActive).v, g / v.z, 3e-6 * g / v.z);
        const glm::vec2 u = uniform.pair();
        const one_lane::V3 m = sample_facet_normal(facets, w, {u.x, u.y}, kActive);
        const double d = reference::normal_density(r, {m.x.v, m.y.v, m.z.v});
        ASSERT_NEAR(facet_density(facets, m, kActive).v, d, 2e-5 * d + 1e-20);
      }
    }
}

// The density of visible normals D(m) G1(v) dot(v, m) / v.z integrates to 1: checked on the independent forms,
// so that density and masking of the reference belong together.
TEST(Microfacet, ReferenceIsNormalised) {
  for (bool ggx : {false, true})
    for (double degrees : {0.0, 45.0, 85.0}) {
      const glm::dvec3 wi(direction(degrees));
      const auto one = [](glm::dvec3) { return glm::dvec3(1, 0, 0); };
      EXPECT_NEAR(reference::mean_over_visible_normals({ggx, 0.4, 0.2}, wi, 500, one).x, 1, 1e-3);
    }
}

// Table nodes against the integral over slopes, the internal reflectance against the same 64-node mean.
// Tolerances: Gauss-Legendre with 32 points against a midpoint rule,
// both good to about 1e-3 at grazing angles.
TEST(Coating, MatchesTheIntegralOverSlopes) {
  for (uint32_t distribution : {0u, KB_MATERIAL_GGX})
    for (float alpha : {0.05f, 0.3f, 0.7f}) {
      const KbMaterial m = rough(KB_MATERIAL_ROUGH_PLASTIC, distribution, alpha, alpha, true, 1.49f);
      const Coating table = make_coating(m);
      const reference::Roughness r{distribution == KB_MATERIAL_GGX, alpha, alpha};
      for (int i : {3, 20, 45, 63}) {
        const glm::dvec3 wi(std::sqrt(1 - i * i / 3969.0), 0, i / 63.0);
        EXPECT_NEAR(table.transmittance[i], reference::rough_albedo(r, wi, 1.49, 200).transmitted, 2e-3)
            << "alpha " << alpha << " node " << i;
      }
      double internal = 0;
      for (int i = 1; i < 64; ++i) {
        const double mu = i / 63.0;
        internal +=
            mu * reference::rough_albedo(r, {std::sqrt(1 - mu * mu), 0, mu}, 1 / 1.49, 60).reflected / 32;
      }
      EXPECT_NEAR(table.internal_reflectance, internal, 3e-3) << "alpha " << alpha;
    }
}

TEST(Coating, SmoothLimitAndInterpolation) {
  const KbMaterial m = rough(KB_MATERIAL_ROUGH_PLASTIC, KB_MATERIAL_GGX, 1e-4f, 1e-4f, true, 1.49f);
  const Coating table = make_coating(m);
  const float* nodes = table.transmittance.data();
  for (int i = 2; i < 64; ++i) {
    const float mu = float(i) / 63;
    EXPECT_NEAR(kb_coat_transmittance(nodes, mu), 1 - double(reference::fresnel(mu, 1.49)), 1e-3);
  }
  EXPECT_FLOAT_EQ(kb_coat_transmittance(nodes, 10.5f / 63),
                  0.5f * (table.transmittance[10] + table.transmittance[11]));
  EXPECT_EQ(kb_coat_transmittance(nodes, 1), table.transmittance[63]);
  EXPECT_EQ(kb_coat_transmittance(nodes, -0.1f), table.transmittance[0]);
  EXPECT_EQ(kb_coat_transmittance(nodes, 1.1f), table.transmittance[63]);
}

}  // namespace
}  // namespace kiloband::test::test_microfacet
