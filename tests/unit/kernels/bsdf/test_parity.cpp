// Random queries: the device's values and samples are the CPU's.
#include <gtest/gtest.h>

#include <cstring>

#include "comparison.hpp"

namespace kiloband::test::test_parity {
namespace {

/// `count` random queries. Half of the wo are samples of the CPU,
/// so that narrow lobes are evaluated where they are.
void add_queries(const Scene& scene, uint32_t material, float dispersion_eta, int count, Uniform& uniform,
                 std::vector<Query>& queries) {
  for (int i = 0; i < count; ++i) {
    Query q{};
    q.material = material;
    q.dispersion_eta = dispersion_eta;
    q.probability = 0.3f;
    const glm::vec3 wi = uniform.direction();
    glm::vec3 wo = uniform.direction();
    if (i % 2) {
      const BsdfSample sample = sample_bsdf(scene.context(q), wi, uniform(), {uniform(), uniform()});
      if (sample.pdf > 0 && !sample.needs_channel) wo = sample.wo;
    }
    for (int k = 0; k < 3; ++k) q.wi[k] = wi[k], q.wo[k] = wo[k];
    q.u_lobe = uniform(), q.u[0] = uniform(), q.u[1] = uniform();
    queries.push_back(q);
  }
}

TEST(DeviceBsdf, AgreesWithTheCpuForEveryMaterial) {
  Scene scene;
  Uniform uniform(1);
  std::vector<Query> queries;
  for (const KbMaterial& material : every_material())
    add_queries(scene, scene.add(material), 1.4f, 3000, uniform, queries);
  Comparison(scene).check(queries, scene.on_cpu(queries), scene.on_device(queries));
}

TEST(DeviceBsdf, AgreesWithTheCpuForPrincipledMaterials) {
  Scene scene;
  Uniform uniform(4);
  std::vector<Query> queries;
  for (const PrincipledExample& example : principled_examples())
    add_queries(scene, scene.add(example), 0, 5000, uniform, queries);
  Comparison(scene).check(queries, scene.on_cpu(queries), scene.on_device(queries));
}

TEST(DeviceBsdf, AgreesWithTheCpuForDispersiveDielectrics) {
  Scene scene;
  Uniform uniform(2);
  std::vector<Query> queries;
  KbMaterial smooth = material_of(KB_MATERIAL_DIELECTRIC);
  smooth.flags |= KB_MATERIAL_DISPERSIVE;
  KbMaterial facets = rough(KB_MATERIAL_ROUGH_DIELECTRIC, KB_MATERIAL_GGX, 0.2f, 0.2f, true);
  facets.flags |= KB_MATERIAL_DISPERSIVE;
  KbMaterial pane = smooth;
  pane.flags |= KB_MATERIAL_THIN;
  const uint32_t first = scene.add(smooth), second = scene.add(facets), third = scene.add(pane);
  // 0: no channel is chosen yet; transmit_dispersive refuses that index
  for (const float eta : {0.0f, 1.0f, 1.4f, 1.7f, 0.6f}) {
    add_queries(scene, first, eta, 10000, uniform, queries);
    if (eta > 0) add_queries(scene, second, eta, 10000, uniform, queries);
    add_queries(scene, third, eta, 10000, uniform, queries);
  }
  const Answers cpu = scene.on_cpu(queries), device = scene.on_device(queries);
  Comparison(scene).check(queries, cpu, device);
  // All outcomes came up: a channel is needed, reflection before the choice, total reflection of a channel.
  int needed = 0, reflected = 0, total = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    needed += (device.samples[i].flags & kNeedsChannel) != 0;
    reflected += device.samples[i].kind == KB_KIND_DISPERSIVE;
    total += queries[i].dispersion_eta > 0 && device.transmitted[i].pdf == 0;
  }
  EXPECT_GT(needed, 1000);
  EXPECT_GT(reflected, 1000);
  EXPECT_GT(total, 1000);
}

TEST(DeviceBsdf, AgreesWithTheCpuForCompensatedMaterials) {
  Scene scene;
  Uniform uniform(9);
  std::vector<Query> queries;
  for (const uint32_t distribution : {0u, KB_MATERIAL_GGX}) {
    for (const KbMaterialType type :
         {KB_MATERIAL_ROUGH_CONDUCTOR, KB_MATERIAL_ROUGH_DIELECTRIC, KB_MATERIAL_ROUGH_PLASTIC}) {
      for (const float alpha_v : {0.4f, 0.1f}) {
        if (type == KB_MATERIAL_ROUGH_PLASTIC && alpha_v != 0.4f) continue;
        KbMaterial material = rough(type, distribution, 0.4f, alpha_v, true);
        material.flags |= KB_MATERIAL_COMPENSATED;
        add_queries(scene, scene.add(material), 0, 3000, uniform, queries);
      }
    }
  }
  KbMaterial dispersive = rough(KB_MATERIAL_ROUGH_DIELECTRIC, KB_MATERIAL_GGX, 0.3f, 0.3f, true);
  dispersive.flags |= KB_MATERIAL_COMPENSATED | KB_MATERIAL_DISPERSIVE;
  add_queries(scene, scene.add(dispersive), 1.66f, 3000, uniform, queries);
  Comparison(scene).check(queries, scene.on_cpu(queries), scene.on_device(queries));
}

/// The bits of what two builds answered.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(DeviceBsdf, SpecialisedBuildsGiveTheSameBits) {
  const char* const macros[KB_MATERIAL_COUNT] = {"DIFFUSE",       "CONDUCTOR",        "ROUGH_CONDUCTOR",
                                                 "DIELECTRIC",    "ROUGH_DIELECTRIC", "PLASTIC",
                                                 "ROUGH_PLASTIC", "PRINCIPLED"};
  for (uint32_t type = 0; type < KB_MATERIAL_COUNT; ++type) {
    Scene scene;
    Uniform uniform(3 + type);
    std::vector<Query> queries;
    for (const KbMaterial& material : every_material())
      if (material.type == type) add_queries(scene, scene.add(material), 0, 200, uniform, queries);
    if (type == KB_MATERIAL_PRINCIPLED)
      for (const PrincipledExample& example : principled_examples())
        add_queries(scene, scene.add(example), 0, 200, uniform, queries);
    const std::string options = std::string("-DKB_SPECIALISED -DKB_HAS_") + macros[type] + "=1";
    const Answers general = scene.on_device(queries), special = scene.on_device(queries, options);
    EXPECT_TRUE(same_bits(general.values, special.values)) << macros[type];
    EXPECT_TRUE(same_bits(general.samples, special.samples)) << macros[type];
    EXPECT_TRUE(same_bits(general.kinds, special.kinds)) << macros[type];
  }
}

}  // namespace
}  // namespace kiloband::test::test_parity
