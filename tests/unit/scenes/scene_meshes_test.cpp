// The meshes of the generated scenes, part by part; those of statues, which take ten times as long, in tests/end_to_end/test_scenes.cpp.
#include <gtest/gtest.h>

#include "scenes/generator/scenes.hpp"
#include "tests/unit/scenes/mesh_checks.hpp"

namespace kiloband::test {
namespace {

using namespace generator;

TEST(SceneMeshes, Conference) {
  EXPECT_GT(check_parts(conference()), 200000u);
}

TEST(SceneMeshes, Aircraft) {
  const Scene scene = aircraft();
  EXPECT_GT(check_parts(scene), 100000u);
  // Mirror symmetry: what stands at x stands at -x.
  for (const auto& [name, part] : scene.parts) {
    Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    for (const Vec3& p : part.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    if (name == "turbine" || name == "compressor") continue;  // blades are twisted
    EXPECT_NEAR(low.x, -high.x, 1e-9) << name;
  }
}

}  // namespace
}  // namespace kiloband::test
