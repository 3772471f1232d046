// Scenes that others wrote: read where the data folder is present.
#include <gtest/gtest.h>

#include "spectral/colour/colour.hpp"
#include "support.hpp"
#include "tests/support/data_folder.hpp"

namespace kiloband::test::test_real_scenes {
namespace {

double value(const Texture& texture, double lambda_nm) {
  return std::get<Spectrum>(texture)(lambda_nm);
}

TEST(RealScenes, SpectralCornellBox) {
  const auto file = data_folder("scenes") / "mitsuba/cbox/cbox-spectral.xml";
  if (!std::filesystem::exists(file)) return;
  const SceneDescription box = read_scene(file);
  ASSERT_EQ(box.shapes.size(), 8u);
  EXPECT_TRUE(box.emitters.empty());
  EXPECT_EQ(box.integrator.max_depth, 6);
  EXPECT_EQ(box.sensor.sample_count, 256u);
  EXPECT_EQ(box.sensor.film.width, 256u);
  EXPECT_EQ(box.sensor.film.filter, FilterType::kBox);
  ASSERT_TRUE(box.shapes[0].emitter);
  EXPECT_DOUBLE_EQ(value(box.shapes[0].emitter->radiance, 550), 11.8);
  EXPECT_EQ(box.shapes[0].to_world[3].y, -0.5);
  EXPECT_EQ(box.shapes[5].bsdf->id, "red");
  EXPECT_DOUBLE_EQ(value(std::get<DiffuseBsdf>(box.shapes[5].bsdf->model).reflectance, 404), 0.046);
  ReadOptions options;
  options.defines = {{"spp", "9"}};
  EXPECT_EQ(read_scene(file, options).sensor.sample_count, 9u);
}

TEST(RealScenes, MaterialPreview) {
  const auto file = data_folder("scenes") / "mitsuba/matpreview/matpreview.xml";
  if (!std::filesystem::exists(file)) return;
  const SceneDescription preview = read_scene(file);
  ASSERT_EQ(preview.shapes.size(), 3u);
  ASSERT_EQ(preview.emitters.size(), 1u);
  EXPECT_EQ(std::get<EnvmapEmitter>(preview.emitters[0].model).scale, 3);
  EXPECT_EQ(std::get<PlasticBsdf>(preview.shapes[2].bsdf->model).int_ior, 1.9);
  const auto& board = std::get<std::shared_ptr<const CheckerboardTexture>>(
      std::get<DiffuseBsdf>(preview.shapes[0].bsdf->model).reflectance);
  EXPECT_EQ(board->to_uv[0][0], 8);
  EXPECT_EQ(preview.sensor.film.width, 683u);
  for (const Shape& shape : preview.shapes)
    EXPECT_FALSE(std::get<MeshShape>(shape.geometry).mesh->triangles.empty());
}

TEST(RealScenes, VeachMisInTheOldFormat) {
  const auto file = data_folder("scenes") / "veach_mi/mi.xml";
  if (!std::filesystem::exists(file)) return;
  std::vector<std::string> warnings;
  ReadOptions options;
  options.sink = [&](const Diagnostic& d) {
    if (d.severity == Severity::kWarning) warnings.push_back(d.message);
  };
  const SceneDescription veach = read_scene(file, options);
  ASSERT_EQ(veach.shapes.size(), 10u);
  EXPECT_EQ(veach.integrator.max_depth, 2);
  EXPECT_EQ(veach.sensor.sample_count, 64u);
  EXPECT_EQ(std::get<PlasticBsdf>(veach.shapes[5].bsdf->model).int_ior, 2);
  EXPECT_EQ(std::get<PlasticBsdf>(veach.shapes[5].bsdf->model).roughness->alpha_u, 0.005);
  EXPECT_NEAR(value(veach.shapes[0].emitter->radiance, 560), 800 * illuminant_d65()(560), 1e-9);
  EXPECT_EQ(veach.shapes[0].to_world[0].x, 0.5);
  EXPECT_GE(warnings.size(), 2u);  // banner, dimension
}

}  // namespace
}  // namespace kiloband::test::test_real_scenes
