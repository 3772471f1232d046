// Extremes: grazing and normal directions, the ends of the random numbers, calls that are bugs of the host.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "comparison.hpp"

namespace kiloband::test::test_edges {
namespace {

std::vector<glm::vec3> directions() {
  std::vector<glm::vec3> all{{1, 0, 0}, {0, -1, 0}};  // wi.z = 0
  for (const float c : {1e-20f, 1e-10f, 1e-7f, 1e-4f, 0.02f, 0.3f, 0.7453f, 0.9f, 0.99999994f, 1.0f})
    for (const float side : {1.0f, -1.0f}) {
      const float s = std::sqrt((1 - c) * (1 + c));
      all.push_back({-0.6f * s, 0.8f * s, side * c});
    }
  return all;
}

Query query_of(uint32_t material, glm::vec3 wi, glm::vec3 wo) {
  Query q{};
  q.material = material;
  q.dispersion_eta = 1.4f;
  q.probability = 0.3f;
  for (int k = 0; k < 3; ++k) q.wi[k] = wi[k], q.wo[k] = wo[k];
  return q;
}

void expect_sane(const Sample& s, const Query& q, const std::string& name) {
  for (const float x : {s.wo[0], s.wo[1], s.wo[2], s.w0, s.w1, s.pdf, s.eta, s.bound})
    ASSERT_TRUE(std::isfinite(x)) << name << " wi.z " << q.wi[2] << " u " << q.u_lobe << " " << q.u[0] << " "
                                  << q.u[1];
  ASSERT_GE(s.pdf, 0) << name;
  ASSERT_GE(s.w0, 0) << name;
  if (s.pdf == 0 || s.flags & kNeedsChannel) return;
  ASSERT_NEAR(std::hypot(s.wo[0], s.wo[1], s.wo[2]), 1, 1e-5) << name;
  ASSERT_EQ((s.flags & kTransmission) != 0, (s.wo[2] > 0) != (q.wi[2] > 0)) << name;
}

TEST(DeviceBsdfEdges, ExtremesAreFiniteAndDecidedAsOnTheCpu) {
  Scene scene;
  std::vector<Query> queries;
  const std::vector<glm::vec3> all = directions();
  std::size_t next = 0;
  std::vector<uint32_t> materials;
  for (const KbMaterial& material : every_material()) materials.push_back(scene.add(material));
  for (const PrincipledExample& example : principled_examples()) materials.push_back(scene.add(example));
  for (const uint32_t index : materials) {
    for (const glm::vec3 wi : all)
      for (const float lobe : {0.0f, 0.05f, 0.5f, KB_ONE_MINUS_EPSILON})
        for (const float u : {0.0f, 1e-8f, 0.25f, 0.5f, 0.999f, KB_ONE_MINUS_EPSILON})
          for (const float v : {0.0f, 0.25f, 0.5f, KB_ONE_MINUS_EPSILON}) {
            Query q = query_of(index, wi, all[next++ % all.size()]);
            q.u_lobe = lobe, q.u[0] = u, q.u[1] = v;
            queries.push_back(q);
          }
  }
  const Answers device = scene.on_device(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const std::string name = describe(scene.material(queries[i].material));
    ASSERT_NO_FATAL_FAILURE(expect_sane(device.samples[i], queries[i], name));
    for (const float x : {device.values[i].w0, device.values[i].w1, device.values[i].pdf}) {
      ASSERT_TRUE(std::isfinite(x)) << name;
      ASSERT_TRUE(x >= 0 || device.kinds[i] == (KB_KIND_TINTED | 256u)) << name;
    }
  }
  Comparison(scene).check(queries, scene.on_cpu(queries), device);
}

TEST(DeviceBsdfEdges, HostBugsScatterNothing) {
  Scene scene;
  std::vector<Query> queries;
  KbMaterial dispersive = rough(KB_MATERIAL_ROUGH_DIELECTRIC, KB_MATERIAL_GGX, 0.2f, 0.2f, true);
  dispersive.flags |= KB_MATERIAL_DISPERSIVE;
  queries.push_back(query_of(scene.add(dispersive), {0, 0, 1}, {0, 0, 1}));
  queries.back().dispersion_eta = 0;  // no channel was chosen
  KbMaterial unknown = material_of(KB_MATERIAL_DIFFUSE);
  unknown.type = KB_MATERIAL_COUNT;
  queries.push_back(query_of(scene.add(unknown), {0, 0, 1}, {0, 0, 1}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const KbMaterial& material : every_material())
    queries.push_back(query_of(scene.add(material), {nan, nan, nan}, {0, 0, 1}));
  KbMaterial plastic = rough(KB_MATERIAL_ROUGH_PLASTIC, KB_MATERIAL_GGX, 0.2f, 0.2f, true);
  queries.push_back(query_of(scene.add_without_table(plastic), {0, 0, 1}, {0, 0, 1}));
  const Answers device = scene.on_device(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const std::string name = describe(scene.material(queries[i].material));
    EXPECT_EQ(device.values[i].pdf, 0) << name;
    EXPECT_EQ(device.values[i].w0, 0) << name;
    EXPECT_EQ(device.values[i].w1, 0) << name;
    EXPECT_EQ(device.samples[i].pdf, 0) << name;
  }
}

}  // namespace
}  // namespace kiloband::test::test_edges
