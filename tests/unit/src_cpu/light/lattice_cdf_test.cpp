// Tables for choosing emitters and triangles: no positive weight is lost, and probabilities are exact.
#include "scene/compile/light/lattice_cdf.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scene/compile/texture/textures.hpp"
#include "spectral/channels.hpp"
#include "src_cpu/lanes/one_lane.hpp"
#include "src_cpu/light/area.hpp"
#include "test_scene.hpp"
#include "tests/support/messages.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/area-inl.hpp"

namespace kiloband::test::lattice_cdf_test {

using namespace cpu;
namespace {

constexpr uint32_t kSteps = 1u << 24;

/// What find_interval() makes of every possible random number.
std::vector<uint32_t> choices(const std::vector<float>& cdf) {
  std::vector<uint32_t> chosen(cdf.size() - 1);
  for (uint32_t i = 0; i < kSteps; ++i) {
    ++chosen[one_lane::find_interval(cdf.data(), 0, static_cast<uint32_t>(chosen.size()),
                                     static_cast<float>(i) * 0x1p-24f)
                 .v];
  }
  return chosen;
}

TEST(LatticeCdf, DifferencesAreExactlyTheProbabilities) {
  const std::vector<double> weights{1e-30, 3, 0, 1e-9, 2, 0, 0.7, 1e-300, 0};
  const std::vector<float> cdf = lattice_cdf(weights);
  const std::vector<uint32_t> chosen = choices(cdf);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_EQ(cdf[i + 1] - cdf[i], static_cast<float>(chosen[i]) * 0x1p-24f) << i;
    EXPECT_NEAR(chosen[i], weights[i] / 5.7 * kSteps, 3) << i;
    EXPECT_EQ(chosen[i] > 0, weights[i] > 0) << i;
  }
}

TEST(LatticeCdf, AsManyItemsAsThereMayBe) {
  // One bright item before, amid and behind 2^22 - 1 dim ones, whose parts are far below a step.
  for (const std::size_t bright : {std::size_t{0}, kMaxLatticeItems / 2, kMaxLatticeItems - 1}) {
    std::vector<double> weights(kMaxLatticeItems, 1e-12);
    weights[bright] = 1;
    const std::vector<float> cdf = lattice_cdf(weights);
    EXPECT_EQ(cdf.front(), 0);
    EXPECT_EQ(cdf.back(), 1);
    float smallest = 1;
    for (std::size_t i = 0; i < weights.size(); ++i) smallest = std::min(smallest, cdf[i + 1] - cdf[i]);
    EXPECT_EQ(smallest, 0x1p-24f);
    EXPECT_EQ(cdf[bright + 1] - cdf[bright], 1 - static_cast<float>(kMaxLatticeItems - 1) * 0x1p-24f);
  }
}

TEST(LatticeCdf, NothingAndZeros) {
  EXPECT_EQ(lattice_cdf({}), std::vector<float>{0});
  EXPECT_EQ(lattice_cdf(std::vector<double>{0, 0}), (std::vector<float>{0, 0, 1}));
  EXPECT_EQ(lattice_cdf(std::vector<double>{5}), (std::vector<float>{0, 1}));
}

TEST(LatticeCdf, RefusesWhatIsNoWeight) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(lattice_cdf(std::vector<double>{1, wrong}), std::logic_error) << wrong;
  }
  EXPECT_THROW(lattice_cdf(std::vector<double>(kMaxLatticeItems + 1, 1.0)), std::logic_error);
}

Emitter point_light(double intensity) {
  return {"", {}, PointEmitter{Spectrum::constant(intensity), {0, 0, 1}}};
}

TEST(EmitterSelection, DimEmittersAmongManyAreSelected) {
  // The uniform part gives each 0.05 / 1 000 000, which is 0.84 of a step; with a whole one they have 0.0596.
  SceneDescription scene;
  scene.emitters.assign(1'000'000, point_light(1e-20));
  scene.emitters[7] = point_light(1);
  scene.integrator.light_selection = LightSelection::kPower;
  const FlatScene flat = *compile_scene(scene, {parse_channels("400:700:1"), {}, {}});
  double sum = 0;
  for (std::size_t i = 0; i < flat.emitters.size(); ++i) {
    ASSERT_GT(flat.emitters[i].select_pdf, 0) << i;
    ASSERT_EQ(flat.emitters[i].select_pdf, flat.emitter_cdf[i + 1] - flat.emitter_cdf[i]) << i;
    ASSERT_EQ(std::remainder(flat.emitter_cdf[i] * 0x1p24f, 1.0f), 0) << i;
    sum += flat.emitters[i].select_pdf;
  }
  EXPECT_EQ(sum, 1);
  EXPECT_NEAR(flat.emitters[7].select_pdf, 1 - 0.0596, 1e-3);
}

TEST(LatticeCdf, MoreItemsThanStepsAllowAreRefused) {
  EXPECT_NO_THROW(check_lattice_items(kMaxLatticeItems, {"scene.xml"}, "emitters of the scene"));
  EXPECT_EQ(
      error_of([&] { check_lattice_items(kMaxLatticeItems + 1, {"scene.xml"}, "emitters of the scene"); }),
      "scene.xml: error: emitters of the scene: 4194305 are too many to choose one of by chance: at most "
      "4194304");
}

/// The density is that of the whole mesh, so that MIS weights sum to 1; over `factor` it is the real one, the
/// probability of the triangle over its area.
TEST(MeshLight, DensityOverFactorIsTheRealOne) {
  // Triangles of areas 1 and 1e-9: the small one has one step, 60 times its part of the area.
  FlatScene scene = scene_with_mesh(
      {{0, 0, 2}, {1, 0, 2}, {0, 2, 2}, {5, 0, 2}, {5.00001f, 0, 2}, {5, 2e-4f, 2}}, {0, 2, 1, 3, 5, 4});
  const double small_area = 0.5 * (double{5.00001f} - 5) * double{2e-4f};
  scene.area_cdf = lattice_cdf(std::vector<double>{1, small_area});
  ASSERT_EQ(scene.area_cdf[1], 1 - 0x1p-24f);
  const glm::vec3 below(5, 0, 0);
  const AreaLightSample small =
      sample_area_light(scene, scene.shapes[0], {1 - 0x1p-24f, KB_NONE, 0}, below, {0.5f, 0.5f}, false);
  EXPECT_NEAR(small.pdf / small.factor * small_area / 0x1p-24 / 4, 1, 1e-6);  // distance 2, cosine 1
  EXPECT_NEAR(small.pdf * scene.shapes[0].area / 4, 1, 1e-6);
  const AreaLightSample large =
      sample_area_light(scene, scene.shapes[0], {0.5f, KB_NONE, 0}, {0, 0, 0}, {0.5f, 0.5f}, false);
  const double distance2 = glm::dot(large.position, large.position);
  const double cosine = 2 / std::sqrt(distance2);
  EXPECT_NEAR(large.pdf / large.factor * cosine / distance2 / (1 - 0x1p-24), 1, 1e-6);
}

TEST(Texels, IndicesBeyond32BitsAreRefused) {
  const SourcePosition position{"scene.xml", 3, 5};
  constexpr std::size_t kMost = std::size_t{1} << 32;
  EXPECT_EQ(first_texel_index(0, 16, position, "leaf"), 0u);
  EXPECT_EQ(first_texel_index(kMost - 16, 16, position, "leaf"), 0xfffffff0u);
  EXPECT_EQ(
      error_of([&] { first_texel_index(kMost - 15, 16, position, "leaf"); }),
      "scene.xml:3:5: error: texture 'leaf': 16 texels after 4294967281 of other textures: all textures "
      "of a scene may have 4294967296 texels together");
}

}  // namespace
}  // namespace kiloband::test::lattice_cdf_test
