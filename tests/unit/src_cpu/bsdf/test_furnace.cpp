// White furnace: mean weights (directional albedo with all reflectances 1 and F = 1 for metals) against
// integrals that share nothing with the code under test.
//
// Rough models scatter once; what would hit the surface again is lost.
// The loss is known: the tests compare with it.
#include <gtest/gtest.h>

#include <cmath>

#include "cases.hpp"
#include "reference.hpp"

namespace kiloband::test::test_furnace {
namespace {

struct Mean {
  double reflected = 0, transmitted = 0, error = 0;  // error: standard error of the sum
};

/// Mean of the factor without radiance scaling, S_a = S_b = 1.
Mean mean_weight(const Case& c, int count, uint64_t seed) {
  const MaterialContext context = context_of(c);
  const bool nonlinear = c.material.flags & KB_MATERIAL_NONLINEAR;
  const bool two_terms =
      c.material.type == KB_MATERIAL_PLASTIC || c.material.type == KB_MATERIAL_ROUGH_PLASTIC;
  Uniform uniform(seed);
  Mean mean;
  double squares = 0;
  for (int i = 0; i < count; ++i) {
    const float u_lobe = uniform();
    const BsdfSample s = sample_bsdf(context, c.wi, u_lobe, uniform.pair());
    if (!(s.pdf > 0)) continue;
    double w = s.w0 * s.eta * s.eta;
    if (two_terms) w += nonlinear ? s.w1 / c.material.escape : s.w1;
    (s.transmission ? mean.transmitted : mean.reflected) += w / count;
    squares += w * w / count;
  }
  const double sum = mean.reflected + mean.transmitted;
  mean.error = std::sqrt(std::max(0.0, squares - sum * sum) / count);
  return mean;
}

constexpr double kSigmas = 4.9;  // two-sided 1e-6 per comparison, below 1e-3 for all of this file
constexpr int kCount = 100000;   // a bias of 7 standard errors (0.2 % to 1 %) is found in 98 of 100 cases

bool is_rough(const KbMaterial& m) {
  return m.type == KB_MATERIAL_ROUGH_CONDUCTOR || m.type == KB_MATERIAL_ROUGH_DIELECTRIC;
}

TEST(Furnace, DiffuseIsLossless) {
  const Case c{"", material_of(KB_MATERIAL_DIFFUSE), direction(50), {}};
  EXPECT_EQ(mean_weight(c, 1000, 1).reflected, mean_weight(c, 1000, 2).reflected);
  EXPECT_NEAR(mean_weight(c, 1000, 1).reflected, 1, 1e-9);
}

TEST(Furnace, SmoothMirrorAndGlassAreLossless) {
  for (double degrees : {0.0, 30.0, 80.0, 100.0, 150.0}) {
    const Mean glass =
        mean_weight({"", material_of(KB_MATERIAL_DIELECTRIC), direction(degrees), {}}, 1000, 1);
    EXPECT_NEAR(glass.reflected + glass.transmitted, 1, 1e-6) << degrees;
    if (degrees > 90) continue;
    EXPECT_NEAR(
        mean_weight({"", material_of(KB_MATERIAL_CONDUCTOR), direction(degrees), {}}, 10, 1).reflected, 1,
        1e-6);
  }
}

// The midpoint rule's own error at the horizon's edge (found by doubling n) is below 5e-4.
TEST(Furnace, RoughModelsLoseExactlyWhatScattersAgain) {
  uint64_t seed = 100;
  for (const Case& c : scattering_cases()) {
    const KbMaterial& m = c.material;
    if (!is_rough(m)) continue;
    // Without visible normals weights have a long tail when rough:
    // only moderate roughness has a usable standard error.
    if (!(m.flags & KB_MATERIAL_SAMPLE_VISIBLE) && std::max(m.alpha_u, m.alpha_v) > 0.1f) continue;
    SCOPED_TRACE(c.name);
    const double index = c.dispersion.eta > 0 ? c.dispersion.eta : m.eta;
    const double eta = m.type == KB_MATERIAL_ROUGH_CONDUCTOR ? 0 : c.wi.z > 0 ? index : 1 / index;
    const reference::Roughness r{(m.flags & KB_MATERIAL_GGX) != 0, m.alpha_u, m.alpha_v};
    const reference::Albedo expected =
        reference::rough_albedo(r, {c.wi.x, c.wi.y, std::abs(c.wi.z)}, eta, 400);
    const Mean mean = mean_weight(c, kCount, seed++);
    EXPECT_LE(mean.reflected + mean.transmitted, 1 + kSigmas * mean.error + 1e-5);
    EXPECT_NEAR(mean.reflected + mean.transmitted, expected.reflected + expected.transmitted,
                kSigmas * mean.error + 1e-3);
    const double split = std::sqrt(0.25 / kCount);  // of the share that is reflected
    EXPECT_NEAR(mean.reflected, expected.reflected, kSigmas * (split + mean.error) + 1e-3);
  }
}

// F(i) + (1 - F(i)) T / (eta^2 (1 - R_int)), T = 2 integral (1 - F) mu dmu. Since T = eta^2 (1 - R_int),
// white plastic is lossless whether linear or not.
TEST(Furnace, PlasticMatchesQuadrature) {
  const double outside = 1 - reference::diffuse_fresnel(1.49), inside = reference::diffuse_fresnel(1 / 1.49);
  EXPECT_NEAR(outside, 1.49 * 1.49 * (1 - inside), 1e-5);
  for (bool nonlinear : {false, true})
    for (double degrees : {5.0, 60.0, 85.0}) {
      const Case c{"", plastic(KB_MATERIAL_PLASTIC, nonlinear), direction(degrees), {}};
      const Mean mean = mean_weight(c, kCount, 9);
      const double f = double(reference::fresnel(c.wi.z, 1.49));
      const double expected = f + (1 - f) * outside / (1.49 * 1.49 * (1 - inside));
      EXPECT_NEAR(mean.reflected, expected, kSigmas * mean.error + 1e-5) << degrees;
    }
}

// Specular part by the integral over slopes; diffuse part T(i) 2 integral T mu dmu / (eta^2 (1 - R_int)) with
// T from the integral over slopes too and R_int from the table, which has a test of its own. Single
// scattering: below 1.
TEST(Furnace, RoughPlasticMatchesQuadrature) {
  for (float alpha : {0.1f, 0.5f}) {
    const reference::Roughness r{true, alpha, alpha};
    double outside = 0;
    for (int i = 0; i < 24; ++i) {
      const double mu = (i + 0.5) / 24;
      outside +=
          2 * mu * reference::rough_albedo(r, {std::sqrt(1 - mu * mu), 0, mu}, 1.49, 80).transmitted / 24;
    }
    for (double degrees : {10.0, 70.0}) {
      const Case c{"", plastic(KB_MATERIAL_ROUGH_PLASTIC, false, alpha), direction(degrees), {}};
      const auto at = reference::rough_albedo(r, glm::dvec3(c.wi), 1.49, 250);
      const double inside = coating_of(c.material).internal_reflectance;
      const double expected = at.reflected + at.transmitted * outside / (1.49 * 1.49 * (1 - inside));
      const Mean mean = mean_weight(c, kCount, 10);
      EXPECT_NEAR(mean.reflected, expected, kSigmas * mean.error + 3e-3) << alpha << " " << degrees;
      EXPECT_LT(mean.reflected, 1);
    }
  }
}

}  // namespace
}  // namespace kiloband::test::test_furnace
