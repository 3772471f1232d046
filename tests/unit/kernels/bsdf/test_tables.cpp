// The tables of rough plastics and metals against the CPU's, which are written independently.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "probe.hpp"
#include "src_cpu/bsdf/conductor_bound.hpp"
#include "src_gpu/scene/material_tables.hpp"

namespace kiloband::test {
namespace {

std::vector<KbMaterial> rough_plastics() {
  std::vector<KbMaterial> all;
  for (const uint32_t distribution : {KB_MICROFACET_BECKMANN, KB_MICROFACET_GGX})
    for (const float alpha : {1e-4f, 0.05f, 0.3f, 1.0f})
      for (const float eta : {1.3f, 1.9f})
        all.push_back(rough(KB_MATERIAL_ROUGH_PLASTIC, distribution, alpha, alpha, true, eta));
  all.push_back(rough(KB_MATERIAL_ROUGH_PLASTIC, KB_MICROFACET_GGX, 0.2f, 0.2f, true, 1.0f));
  all.push_back(rough(KB_MATERIAL_ROUGH_PLASTIC, KB_MICROFACET_GGX, 0.2f, 0.2f, true, 0.8f));
  return all;
}

/// Spectra: n and k of a metal like gold, and k of a dielectric.
FlatScene metal_scene() {
  FlatScene scene;
  scene.channels = {{400, 450, ""}, {600, 700, ""}};
  scene.guide = {{500, 520, ""}, {690, 800, ""}};
  const auto row = [](std::vector<double> values) {
    SpectrumRow r;
    r.table = {380, 140, std::move(values), true, 0};
    return r;
  };
  scene.spectra = {row({1.6, 1.1, 0.2, 0.15}), row({1.9, 1.8, 3.3, 4.9}), row({0, 0, 0, 0})};
  KbMaterial metal = material_of(KB_MATERIAL_CONDUCTOR);
  metal.eta_row = 0, metal.k_row = 1;
  KbMaterial same = metal, other = metal, mirror = metal, vacuum = metal;
  same.type = other.type = KB_MATERIAL_ROUGH_CONDUCTOR;
  other.k_row = 2;
  mirror.flags |= KB_MATERIAL_PERFECT_MIRROR;
  mirror.eta_row = mirror.k_row = KB_NONE;
  vacuum.eta_row = vacuum.k_row = 2;  // n = k = 0: reflects everything
  scene.materials = {metal, same, material_of(KB_MATERIAL_DIFFUSE), other, mirror, vacuum};
  return scene;
}

TEST(MaterialTables, RoughPlasticsAreTheCpus) {
  FlatScene scene;
  scene.materials = rough_plastics();
  const std::vector<float> tables = gpu::make_material_tables(scene);
  ASSERT_EQ(tables.size(), scene.materials.size() * gpu::kRoughPlasticNodes);
  for (const KbMaterial& material : scene.materials) {
    const RoughTransmittance cpu = make_rough_transmittance(material);
    ASSERT_LE(material.table + gpu::kRoughPlasticNodes, tables.size());
    for (int i = 0; i < gpu::kRoughPlasticNodes; ++i)
      EXPECT_NEAR(tables[material.table + i], cpu.external[i], 1e-5) << describe(material) << " node " << i;
    EXPECT_NEAR(material.fdr_int, cpu.internal_reflectance, 1e-5) << describe(material);
  }
}

/// In the limit of a smooth boundary the transmittance is 1 - F: 4 n / (n + 1)^2 at normal incidence, and at
/// Brewster's angle, where one polarisation passes whole, 1 - ((n^2 - 1) / (n^2 + 1))^2 / 2.
TEST(MaterialTables, SmoothLimit) {
  FlatScene scene;
  scene.materials = {rough(KB_MATERIAL_ROUGH_PLASTIC, KB_MICROFACET_GGX, 1e-4f, 1e-4f, true, 1.5f)};
  const std::vector<float> tables = gpu::make_material_tables(scene);
  EXPECT_NEAR(tables[63], 0.96, 1e-5);
  const double n2 = 1.5 * 1.5, brewster_cos = 1 / std::sqrt(1 + n2);
  const double expected = 1 - 0.5 * std::pow((n2 - 1) / (n2 + 1), 2);
  const double x = brewster_cos * 63;
  const int i = static_cast<int>(x);
  const double between = tables[i] + (x - i) * (tables[i + 1] - tables[i]);
  EXPECT_NEAR(between, expected, 1e-3);  // linear interpolation: 1/8 h^2 T'' = 4e-4
}

TEST(MaterialTables, MetalsAreTheCpus) {
  FlatScene scene = metal_scene();
  const std::vector<float> tables = gpu::make_material_tables(scene);
  const auto& m = scene.materials;
  EXPECT_EQ(m[2].table, KB_NONE);
  EXPECT_EQ(m[4].table, KB_NONE);
  EXPECT_EQ(m[0].table, m[1].table);  // one table for equal metals
  ASSERT_EQ(tables.size(), 3u * (gpu::kConductorCells + 1));
  std::vector<float> cosines;
  for (int i = 0; i <= 1000; ++i) cosines.push_back(static_cast<float>(i) / 1000);
  for (const int index : {0, 1, 3, 5}) {
    const ConductorBound cpu(scene, m[index]);
    const std::vector<float> table(tables.begin() + m[index].table,
                                   tables.begin() + m[index].table + gpu::kConductorCells + 1);
    const std::vector<float> device = conductor_bound_on_device(table, cosines);
    for (std::size_t i = 0; i < cosines.size(); ++i)
      ASSERT_NEAR(device[i], cpu.at(cosines[i]), 1e-5) << "material " << index << " cos " << cosines[i];
  }
}

TEST(MaterialTables, WithoutTableTheBoundIsOne) {
  EXPECT_EQ(conductor_bound_on_device({}, {0.0f, 0.5f, 1.0f}), std::vector<float>(3, 1.0f));
}

TEST(MaterialTables, ASpectrumThatIsNotThereIsOurBug) {
  FlatScene scene = metal_scene();
  scene.materials[0].k_row = 17;
  EXPECT_THROW(gpu::make_material_tables(scene), std::logic_error);
}

}  // namespace
}  // namespace kiloband::test
