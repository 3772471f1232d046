// Which side of a mesh shines, where vertex normals and winding may say different things.
#include <gtest/gtest.h>

#include "src_cpu/lanes/one_lane_glm.hpp"
#include "test_scene.hpp"
#include "tests/support/one_path_lights.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/area-inl.hpp"

namespace kiloband::test::light_side_test {

using namespace cpu;
namespace {

// Where they oppose the winding, samples, their density and that of rays change sides with them; the target
// is off the side that is seen.
TEST(MeshLight, VertexNormalsDecideTheSideThatShines) {
  for (const bool winding_faces_point : {false, true}) {
    for (const bool normals_face_point : {false, true}) {
      for (const bool flipped : {false, true}) {
        const FlatScene scene = quad_with_normals(winding_faces_point, 0, normals_face_point ? -1.0f : 1.0f,
                                                  flipped ? KB_SHAPE_FLIP_NORMALS : 0);
        const LightSample sample = sample_light(scene, glm::vec3(0), {0.5f, 0.5f}, {0.3f, 0.7f});
        const glm::dvec3 ahead(0, 0.1, 1);
        const SurfaceHit hit = surface_at(scene, trace(scene, glm::dvec3(0), ahead), glm::dvec3(0), ahead);
        const bool shines = normals_face_point != flipped;
        EXPECT_EQ(sample.pdf > 0, shines);
        EXPECT_EQ(area_light_pdf(scene, hit, glm::vec3(0)) > 0, shines);
        EXPECT_EQ(one_lane::on_front(to_lane(hit.shading_normal), to_lane(-glm::vec3(ahead))).v, shines);
        if (!shines) continue;
        EXPECT_LT(sample.target.z, 2);
        EXPECT_GT(sample.target.z, 1.999f);
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::light_side_test
