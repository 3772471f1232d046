// The meshes of the generated scenes, part by part.
#include <gtest/gtest.h>

#include <set>

#include "scenes/generator/scenes.hpp"
#include "tests/unit/scenes/mesh_checks.hpp"

namespace kiloband::test {
namespace {

using namespace generator;

/// Parts that are surfaces without an inside.
const std::set<std::string> kOpen{
    "floor",         "display",     "outside",      "luminaires", "laptop_screens", "paper",       "blinds",
    "leaves",        "coffee",      "soil",         "meadow",     "skin",           "compressor",  "turbine",
    "leading_edges", "intake_lips", "intake_ducts", "nozzle_lip", "nozzle_rear",    "nozzle_front"};

std::size_t check_parts(const Scene& scene) {
  std::size_t triangles = 0;
  for (const auto& [name, part] : scene.parts) {
    SCOPED_TRACE(scene.name + "/" + name);
    const Mesh mesh = in_single_precision(part);
    EXPECT_EQ(fault_of(mesh), "");
    EXPECT_LT(share_of_turned_normals(mesh), 1e-3);
    if (kOpen.contains(name)) {
      EXPECT_TRUE(is_oriented(mesh));
      EXPECT_FALSE(is_closed(mesh)) << "belongs to the closed ones";
    } else {
      EXPECT_TRUE(is_closed(mesh));
      EXPECT_GT(signed_volume6(mesh), 0);
    }
    triangles += mesh.triangles.size();
  }
  return triangles;
}

TEST(SceneMeshes, Conference) {
  EXPECT_GT(check_parts(conference()), 200000u);
}

TEST(SceneMeshes, Statues) {
  const Scene scene = statues();
  check_parts(scene);
  std::size_t sculptures = 0;
  for (const char* name : {"bust", "veiled_figure", "gyroid_ball", "glass_knot", "twisted_column"}) {
    sculptures += scene.parts.at(name).triangles.size();
  }
  EXPECT_GT(sculptures, 300000u);
  // What light goes through must bound a volume without any doubt.
  EXPECT_TRUE(is_manifold(in_single_precision(scene.parts.at("glass_knot"))));
  EXPECT_TRUE(is_manifold(in_single_precision(scene.parts.at("veiled_figure"))));
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
