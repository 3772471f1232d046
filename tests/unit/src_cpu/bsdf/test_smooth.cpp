// Delta lobes: mirrors, glass and dispersion.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "cases.hpp"
#include "reference.hpp"

namespace kiloband::test::test_smooth {
namespace {

BsdfSample sample(const KbMaterial& m, glm::vec3 wi, float u_lobe, DispersionState dispersion = {}) {
  return sample_bsdf({&m, nullptr, dispersion}, wi, u_lobe, {0.3f, 0.7f});
}

TEST(SmoothBsdf, ConductorMirrorsAndHandsItsCosineToEvaluation) {
  KbMaterial m = material_of(KB_MATERIAL_CONDUCTOR);
  m.bound_a = 0.9f;
  const glm::vec3 wi = direction(35);
  const BsdfSample s = sample(m, wi, 0.5f);
  EXPECT_EQ(s.wo, glm::vec3(-wi.x, -wi.y, wi.z));
  EXPECT_EQ(s.kind, KB_KIND_CONDUCTOR);
  EXPECT_EQ(s.w0, 1);
  EXPECT_EQ(s.w1, wi.z);
  EXPECT_EQ(s.pdf, 1);
  EXPECT_EQ(s.bound, 0.9f);
  EXPECT_TRUE(s.delta);
  EXPECT_EQ(eval_bsdf({&m, nullptr, {}}, wi, s.wo).w0, 0);
  EXPECT_EQ(sample(m, direction(100), 0.5f).pdf, 0);
}

TEST(SmoothBsdf, PerfectMirrorIsScaled) {
  for (KbMaterialType type : {KB_MATERIAL_CONDUCTOR, KB_MATERIAL_ROUGH_CONDUCTOR}) {
    KbMaterial m = material_of(type);
    m.flags |= KB_MATERIAL_PERFECT_MIRROR;
    EXPECT_EQ(eval_kind(m), KB_KIND_SCALED);
    const BsdfSample s = sample(m, direction(35), 0.5f);
    EXPECT_EQ(s.kind, KB_KIND_SCALED);
    EXPECT_GT(s.w0, 0.9f);
    EXPECT_EQ(s.w1, 0);
  }
}

TEST(SmoothBsdf, WhichMaterialsTakeLightSamples) {
  EXPECT_FALSE(has_smooth_lobe(material_of(KB_MATERIAL_CONDUCTOR)));
  EXPECT_FALSE(has_smooth_lobe(material_of(KB_MATERIAL_DIELECTRIC)));
  for (KbMaterialType type : {KB_MATERIAL_DIFFUSE, KB_MATERIAL_ROUGH_CONDUCTOR, KB_MATERIAL_ROUGH_DIELECTRIC,
                              KB_MATERIAL_PLASTIC, KB_MATERIAL_ROUGH_PLASTIC})
    EXPECT_TRUE(has_smooth_lobe(material_of(type)));
}

/// What leaves a pane after any number of reflections inside, summed one by one.
double pane_series(double f) {
  double inside = 1 - f, reflected = f;
  for (int i = 0; i < 2000; ++i) {
    inside *= f;  // at the back
    reflected += inside * (1 - f);
    inside *= f;  // at the front
  }
  return reflected;
}

// Both sides are the outside; light that passes goes straight on, without radiance scaling.
TEST(SmoothBsdf, PanesSumTheReflectionsInside) {
  KbMaterial m = material_of(KB_MATERIAL_DIELECTRIC);
  m.flags |= KB_MATERIAL_THIN;
  m.bound_a = 0.7f;
  m.bound_b = 0.6f;
  for (const float eta : {1.5f, 0.8f}) {
    m.eta = eta;
    for (double degrees : {0.0, 10.0, 45.0, 70.0, 89.0, 91.0, 120.0, 179.0}) {
      SCOPED_TRACE(degrees);
      const glm::vec3 wi = direction(degrees);
      const double expected = pane_series(double(reference::fresnel(std::abs(wi.z), eta)));
      const BsdfSample r = sample(m, wi, 0);
      EXPECT_EQ(r.wo, glm::vec3(-wi.x, -wi.y, wi.z));
      EXPECT_NEAR(r.pdf * r.w0, expected, 2e-6);
      EXPECT_FALSE(r.lobe_b);
      EXPECT_EQ(r.bound, 0.7f);
      const BsdfSample t = sample(m, wi, 0.9999999f);
      if (expected > 0.999) continue;
      EXPECT_NEAR(t.pdf * t.w0, 1 - expected, 2e-6);
      EXPECT_TRUE(t.lobe_b && t.transmission && t.delta);
      EXPECT_EQ(t.wo, -wi);
      EXPECT_EQ(t.eta, 1);
      EXPECT_EQ(t.bound, 0.6f);
    }
  }
}

// With an index that depends on the wavelength both ways are for all channels: evaluation applies the channel's
// share, told which by the sign of w1. Once a channel is chosen it is a pane of its index.
TEST(SmoothBsdf, DispersivePanesKeepAllChannels) {
  KbMaterial m = material_of(KB_MATERIAL_DIELECTRIC);
  m.flags |= KB_MATERIAL_THIN | KB_MATERIAL_DISPERSIVE;
  for (double degrees : {0.0, 60.0, 85.0, 100.0, 180.0}) {
    SCOPED_TRACE(degrees);
    const glm::vec3 wi = direction(degrees);
    const BsdfSample r = sample(m, wi, 0), t = sample(m, wi, 0.9999999f);
    for (const BsdfSample* s : {&r, &t}) {
      EXPECT_EQ(s->kind, KB_KIND_DISPERSIVE);
      EXPECT_FALSE(s->needs_channel);
      EXPECT_TRUE(s->delta);
      EXPECT_FLOAT_EQ(s->w0 * s->pdf, 1);
    }
    EXPECT_FLOAT_EQ(r.pdf + t.pdf, 1);
    EXPECT_GE(std::min(r.pdf, t.pdf), 0.0999f);
    EXPECT_EQ(r.w1, std::abs(wi.z));
    EXPECT_EQ(t.w1, -std::abs(wi.z));
    EXPECT_TRUE(t.lobe_b && t.transmission);
    EXPECT_EQ(t.wo, -wi);
    const BsdfSample one = sample(m, wi, 0, {1.7f});
    EXPECT_EQ(one.kind, KB_KIND_SCALED);
    EXPECT_NEAR(one.pdf, pane_series(double(reference::fresnel(std::abs(wi.z), 1.7))), 2e-6);
  }
}

// Reflected share F, transmitted share 1 - F, Snell's law, both sides, total internal reflection included.
TEST(SmoothBsdf, DielectricFollowsFresnelAndSnell) {
  KbMaterial m = material_of(KB_MATERIAL_DIELECTRIC);
  m.bound_a = 0.7f;
  m.bound_b = 0.6f;
  for (double degrees : {0.0, 10.0, 45.0, 89.0, 91.0, 120.0, 135.0, 140.0, 179.0}) {
    SCOPED_TRACE(degrees);
    const glm::vec3 wi = direction(degrees);
    const double eta = degrees < 90 ? 1.5 : 1 / 1.5;
    const double f = double(reference::fresnel(std::abs(wi.z), eta));
    const BsdfSample r = sample(m, wi, 0);
    EXPECT_EQ(r.wo, glm::vec3(-wi.x, -wi.y, wi.z));
    EXPECT_NEAR(r.pdf * r.w0, f, 2e-6);
    EXPECT_FALSE(r.lobe_b);
    EXPECT_EQ(r.bound, 0.7f);
    const BsdfSample t = sample(m, wi, 0.9999999f);
    if (f == 1) {
      EXPECT_FALSE(t.transmission);
      continue;
    }
    EXPECT_NEAR(t.pdf * t.w0 * eta * eta, 1 - f, 2e-6);
    EXPECT_TRUE(t.lobe_b && t.transmission && t.delta);
    EXPECT_NEAR(t.eta, eta, 1e-6);
    EXPECT_FLOAT_EQ(t.bound, 0.6f);
    EXPECT_NEAR(t.wo.x * eta, -wi.x, 1e-6);
    EXPECT_NEAR(t.wo.y * eta, -wi.y, 1e-6);
    EXPECT_LT(t.wo.z * wi.z, 0);
    EXPECT_NEAR(glm::length(t.wo), 1, 1e-6);
  }
}

KbMaterial prism_glass() {
  KbMaterial m = material_of(KB_MATERIAL_DIELECTRIC);
  m.flags |= KB_MATERIAL_DISPERSIVE;
  return m;
}

// In expectation every channel k gets F_k reflected and 1 - F_k transmitted,
// whatever its index: probabilities cancel.
TEST(Dispersion, EveryChannelKeepsItsShare) {
  const KbMaterial m = prism_glass();
  for (double degrees : {5.0, 60.0, 88.0, 130.0, 138.0, 139.5, 175.0}) {
    const glm::vec3 wi = direction(degrees);
    const BsdfSample r = sample(m, wi, 0), t = sample(m, wi, 0.9999999f);
    ASSERT_EQ(r.kind, KB_KIND_DISPERSIVE);
    EXPECT_EQ(r.w1, wi.z);  // signed
    EXPECT_FLOAT_EQ(r.w0 * r.pdf, 1);
    EXPECT_FALSE(r.needs_channel);
    ASSERT_TRUE(t.needs_channel);
    EXPECT_NEAR(r.pdf + t.pdf, 1, 1e-6);
    EXPECT_GE(r.pdf, 0.1f);
    EXPECT_GE(t.pdf, 0.0999f);
    for (float index : {1.3f, 1.49f, 1.52f, 1.8f}) {
      const double eta = degrees < 90 ? index : 1 / index;
      const double f = double(reference::fresnel(std::abs(wi.z), eta));
      const BsdfSample s = transmit_dispersive(m, wi, index, t.pdf * 0.25f);
      if (f == 1) {
        EXPECT_EQ(s.pdf, 0);
        continue;
      }
      EXPECT_NEAR(s.w0 * t.pdf * 0.25 * eta * eta, 1 - f, 1e-5) << degrees << " " << index;
      EXPECT_NEAR(s.bound, s.w0 * eta * eta, 1e-4 * s.bound);
      EXPECT_TRUE(s.lobe_b && s.transmission && s.delta);
      EXPECT_EQ(s.kind, KB_KIND_SCALED);
      EXPECT_NEAR(s.wo.x * eta, -wi.x, 1e-6);
      EXPECT_LT(s.wo.z * wi.z, 0);
      EXPECT_NEAR(glm::length(s.wo), 1, 1e-6);
    }
  }
}

TEST(Dispersion, AfterDegradationItIsAnOrdinaryDielectric) {
  const KbMaterial m = prism_glass();
  KbMaterial plain = material_of(KB_MATERIAL_DIELECTRIC);
  plain.eta = 1.7f;
  for (double degrees : {30.0, 150.0})
    for (float u : {0.0f, 0.5f, 0.99f}) {
      const BsdfSample a = sample(m, direction(degrees), u, {1.7f}), b = sample(plain, direction(degrees), u);
      EXPECT_EQ(a.wo, b.wo);
      EXPECT_EQ(a.w0, b.w0);
      EXPECT_EQ(a.pdf, b.pdf);
      EXPECT_FALSE(a.needs_channel);
    }
}

TEST(Dispersion, MissingContextIsAnError) {
  KbMaterial m = rough(KB_MATERIAL_ROUGH_DIELECTRIC, KB_MATERIAL_GGX, 0.1f, 0.1f, true);
  m.flags |= KB_MATERIAL_DISPERSIVE;
  EXPECT_THROW(sample(m, direction(30), 0.5f), std::logic_error);
  EXPECT_THROW(eval_bsdf({&m, nullptr, {}}, direction(30), direction(20)), std::logic_error);
  const KbMaterial p = plastic(KB_MATERIAL_ROUGH_PLASTIC, false);
  EXPECT_THROW(sample(p, direction(30), 0.5f), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test::test_smooth
