// Extremes: nothing may become infinite or NaN, and directions stay unit vectors on the right side.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "cases.hpp"
#include "tests/support/principled_numbers.hpp"

namespace kiloband::test::test_hard_cases {
namespace {

constexpr float kCosines[] = {1e-38f, 1e-20f,    1e-10f, 1e-7f,       1e-4f, 0.02f,
                              0.3f,   0.745356f, 0.9f,   0.99999994f, 1.0f};
constexpr float kUniforms[] = {0.0f, 1e-8f, 0.001f, 0.25f, 0.5f, 0.75f, 0.999f, 0.99999994f};

std::vector<glm::vec3> directions() {
  std::vector<glm::vec3> result;
  for (float c : kCosines)
    for (float side : {1.0f, -1.0f}) {
      const float s = std::sqrt((1 - c) * (1 + c));
      result.push_back({s, 0, side * c});
      result.push_back({-0.6f * s, 0.8f * s, side * c});
    }
  result.push_back({1, 0, 0});
  return result;
}

void check(const BsdfSample& s, glm::vec3 wi) {
  for (float x : {s.wo.x, s.wo.y, s.wo.z, s.w0, s.w1, s.pdf, s.eta, s.bound}) ASSERT_TRUE(std::isfinite(x));
  ASSERT_GE(s.pdf, 0);
  ASSERT_GE(s.w0, 0);
  ASSERT_GE(s.bound, 0);
  if (s.pdf == 0 || s.needs_channel) return;
  ASSERT_NEAR(glm::length(s.wo), 1, 1e-5);
  ASSERT_EQ(s.transmission, (s.wo.z > 0) != (wi.z > 0));
}

/// tinted: KB_KIND_TINTED, whose w1 has a sign
void check(const BsdfValue& v, bool tinted) {
  for (float x : {v.w0, tinted ? std::abs(v.w1) : v.w1, v.pdf}) {
    ASSERT_TRUE(std::isfinite(x));
    ASSERT_GE(x, 0);
  }
}

void check_material(const Case& c, const std::vector<glm::vec3>& all) {
  const MaterialContext context = context_of(c);
  const bool tinted = c.material.type == KB_MATERIAL_PRINCIPLED;
  for (glm::vec3 wi : all) {
    for (glm::vec3 wo : all) ASSERT_NO_FATAL_FAILURE(check(eval_bsdf(context, wi, wo), tinted));
    for (float a : kUniforms)
      for (float b : kUniforms)
        for (float lobe : {0.0f, 0.04f, 0.5f, 0.99999994f})
          ASSERT_NO_FATAL_FAILURE(check(sample_bsdf(context, wi, lobe, {a, b}), wi))
              << "wi " << wi.x << " " << wi.y << " " << wi.z << " u " << lobe << " " << a << " " << b;
  }
}

TEST(HardCases, RoughMaterialsStayFinite) {
  const std::vector<glm::vec3> all = directions();
  for (uint32_t distribution : {0u, KB_MATERIAL_GGX})
    for (bool visible : {true, false})
      for (float alpha : {0.0f, 1e-4f, 1e-3f, 0.1f, 1.0f, 5.0f}) {
        SCOPED_TRACE(testing::Message()
                     << "distribution " << distribution << " visible " << visible << " alpha " << alpha);
        const KbMaterial metal = rough(KB_MATERIAL_ROUGH_CONDUCTOR, distribution, alpha, 0.3f, visible);
        ASSERT_NO_FATAL_FAILURE(check_material({"", metal, {}, {}}, all));
        for (float eta : {0.3f, 0.9999f, 0.99999994f, 1.0f, 1.0000001f, 1.0001f, 1.5f, 4.0f}) {
          SCOPED_TRACE(testing::Message() << "eta " << eta);
          const KbMaterial glass =
              rough(KB_MATERIAL_ROUGH_DIELECTRIC, distribution, alpha, alpha, visible, eta);
          ASSERT_NO_FATAL_FAILURE(check_material({"", glass, {}, {}}, all));
        }
      }
}

TEST(HardCases, SmoothAndCoatedMaterialsStayFinite) {
  const std::vector<glm::vec3> all = directions();
  for (float eta : {0.3f, 0.99999994f, 1.0f, 1.0000001f, 1.5f, 4.0f}) {
    SCOPED_TRACE(testing::Message() << "eta " << eta);
    for (KbMaterialType type :
         {KB_MATERIAL_DIFFUSE, KB_MATERIAL_CONDUCTOR, KB_MATERIAL_DIELECTRIC, KB_MATERIAL_PLASTIC}) {
      for (float weight : {0.0f, 0.5f, 1.0f}) {
        KbMaterial m = material_of(type);
        m.eta = eta;
        m.specular_weight = weight;
        m.escape = 0.1f;
        ASSERT_NO_FATAL_FAILURE(check_material({"", m, {}, {}}, all));
      }
    }
    KbMaterial glass = material_of(KB_MATERIAL_DIELECTRIC);
    glass.eta = eta;
    glass.flags |= KB_MATERIAL_DISPERSIVE;
    ASSERT_NO_FATAL_FAILURE(check_material({"", glass, {}, {}}, all));
    for (glm::vec3 wi : all) ASSERT_NO_FATAL_FAILURE(check(transmit_dispersive(glass, wi, eta, 0.01f), wi));
  }
  for (float alpha : {1e-4f, 1.0f})
    ASSERT_NO_FATAL_FAILURE(
        check_material({"", plastic(KB_MATERIAL_ROUGH_PLASTIC, true, alpha), {}, {}}, all));
}

TEST(HardCases, PrincipledMaterialsStayFinite) {
  const std::vector<glm::vec3> all = directions();
  for (const PrincipledExample& example : principled_examples())
    for (const float eta : {1.0f, 1.001f, 1.5f, 10.0f})
      for (const float roughness : {0.0f, 1e-3f, 1.0f}) {
        SCOPED_TRACE(testing::Message() << example.name << " eta " << eta << " roughness " << roughness);
        PrincipledNumbers numbers = example.numbers;
        numbers[KB_PRINCIPLED_ETA] = eta;
        numbers[KB_PRINCIPLED_ROUGHNESS] = roughness;
        numbers[KB_PRINCIPLED_LUMINANCE] = roughness;
        ASSERT_NO_FATAL_FAILURE(check_material({"", principled_material(example), {}, {}, numbers}, all));
      }
}

TEST(HardCases, NotANumberEndsThePath) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Case& c : scattering_cases()) {
    const MaterialContext context = context_of(c);
    EXPECT_EQ(sample_bsdf(context, {nan, nan, nan}, 0.5f, {0.5f, 0.5f}).pdf, 0) << c.name;
    EXPECT_FALSE(eval_bsdf(context, {nan, nan, nan}, {0, 0, 1}).pdf > 0) << c.name;
  }
}

}  // namespace
}  // namespace kiloband::test::test_hard_cases
