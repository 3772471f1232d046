// Instances against the same scene written out, and against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <random>

#include "pixel_mean.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/geometry/surface_hit.hpp"
#include "tests/support/render_harness.hpp"
#include "tests/support/scene_text.hpp"

namespace kiloband::test::test_instances {

using namespace cpu;
namespace {

using namespace scene_text;

Text group(const Text& id, const Text& contents) {
  return "<shape type='shapegroup' id='" + id + "'>" + contents + "</shape>";
}
Text instance(const Text& id, const Text& steps) {
  return "<shape type='instance'><ref id='" + id + "'/>" + to_world(steps) + "</shape>";
}

/// Turned, stretched, flattened to a hundredth before and after a turn, small and far, large.
const Text kPlaces[] = {turn("x", "30") + translate("1 2 -1"),
                        scale(0.3, 1.5, 0.7) + rotate(0.6, 0.8, 0, 70) + translate("-2 0 3"),
                        scale(1, 0.01, 1) + rotate(0.6, 0, 0.8, 40) + translate("3 -3 0"),
                        rotate(0.6, 0, 0.8, 40) + scale(1, 0.01, 1) + translate("-3 3 30"),
                        scale("0.001") + turn("y", "10") + translate("0 40 0"),
                        scale("30") + translate("0 0 100")};

/// Members of a group: `steps` after their own.
Text members(const Text& steps) {
  return shape("cube", scale(0.5, 1, 0.25) + turn("y", "20") + steps, diffuse("0.5")) +
         shape("rectangle", translate("0 0 2") + steps, yes("flip_normals") + diffuse("0.5")) +
         shape("sphere", steps, diffuse("0.5")) + shape("cube", translate("2 2 2") + steps, diffuse("0.5"));
}

FlatScene compiled(const Text& shapes) {
  const ChannelList channels = parse_channels("500-510");
  return *compile_scene(
      read_scene_text(scene(2, perspective(lookat("0, 0, 9", "0, 0, 0"), 30, film(8)) + shapes + sky("1")),
                      "scene.xml", "."),
      {channels, channels, {}});
}

class Directions {
 public:
  glm::vec3 operator()() {
    for (;;) {
      const glm::vec3 v(unit_(random_), unit_(random_), unit_(random_));
      const float length = glm::length(v);
      if (length > 0.01f && length <= 1) return v / length;
    }
  }

 private:
  std::mt19937 random_{7};
  std::uniform_real_distribution<float> unit_{-1, 1};
};

SurfaceHit surface_of(const FlatScene& scene, const TraceRay& ray) {
  return make_surface_hit(scene, ray.shape, ray.primitive, ray.u, ray.v, ray.origin(), ray.direction(),
                          ray.t_max);
}

// What a hit is made of: the same but for rounding, which grows with the distance from the origin.
TEST(Instances, HitsAreThoseOfTheSceneWrittenOut) {
  const Text similar = scale("0.7") + rotate(0.6, 0.8, 0, 70) + translate("1 -2 3");
  const FlatScene one = compiled(group("g", members("")) + instance("g", similar));
  const FlatScene plain = compiled(members(similar));
  ASSERT_EQ(one.shapes.size(), plain.shapes.size());
  const uint32_t in_plain[] = {0, 1, 3, 2};  // the sphere stands behind the meshes
  const EmbreeScene traced(one, Isa::kSse4, 1), expected(plain, Isa::kSse4, 1);
  Directions direction;
  int hits = 0, others = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 from = glm::vec3(1, -2, 3) + 4.0f * direction();
    TraceRay a(from, glm::vec3(1, -2, 3) + direction() - from, 0, INFINITY), b = a;
    traced.closest_hits({&a, 1});
    expected.closest_hits({&b, 1});
    if ((a.shape == KB_NONE ? KB_NONE : in_plain[a.shape]) != b.shape || a.primitive != b.primitive) {
      ++others;
      continue;
    }
    if (a.shape == KB_NONE) continue;
    ++hits;
    const SurfaceHit x = surface_of(one, a), y = surface_of(plain, b);
    const float cosine = std::abs(glm::dot(glm::normalize(b.direction()), y.geometric_normal));
    EXPECT_LT(std::abs(glm::dot(x.point - y.point, y.geometric_normal)), 2e-6f);
    const float apart = 5e-6f / cosine;  // m
    EXPECT_LT(glm::length(x.point - y.point), apart);
    EXPECT_LT(glm::length(x.geometric_normal - y.geometric_normal), 1e-5f);
    EXPECT_LT(glm::length(x.shading_normal - y.shading_normal), 1e-5f);
    EXPECT_LT(glm::length(x.tangent - y.tangent), 1e-5f * (1 + glm::length(y.tangent)));
    // Along the shortest edge, the flat cube's of 0.35 m, uv go from 0 to 1.
    EXPECT_LT(glm::length(x.uv - y.uv), apart / 0.35f);
    EXPECT_GE(x.offset, 0.5f * y.offset);
  }
  EXPECT_GT(hits, 5000);
  EXPECT_LE(others, 2);  // on edges
}

// Rays that leave a convex body outwards do not meet it again, whatever its place.
TEST(Instances, RaysLeaveThem) {
  for (const Text& place : kPlaces) {
    const FlatScene scene =
        compiled(group("g", shape("cube", turn("z", "45"), diffuse("0.5"))) + instance("g", place));
    const EmbreeScene traced(scene, Isa::kSse4, 1);
    const float* m = scene.shapes[0].to_world;
    const glm::vec3 middle(m[3], m[7], m[11]);
    Directions direction;
    int hits = 0, again = 0;
    for (int i = 0; i < 20000; ++i) {
      const glm::vec3 d = direction(), o = direction();
      const auto placed = [&](glm::vec3 p) {
        return glm::vec3(m[0] * p.x + m[1] * p.y + m[2] * p.z, m[4] * p.x + m[5] * p.y + m[6] * p.z,
                         m[8] * p.x + m[9] * p.y + m[10] * p.z);
      };
      TraceRay ray(middle + 4.0f * placed(d), placed(o) - 4.0f * placed(d), 0, INFINITY);
      traced.closest_hits({&ray, 1});
      if (ray.shape == KB_NONE) continue;
      ++hits;
      const SurfaceHit hit = surface_of(scene, ray);
      glm::vec3 away = direction();
      if (glm::dot(away, hit.geometric_normal) < 0) away = -away;
      ShadowRay shadow(hit.departure + hit.offset * hit.geometric_normal, away, INFINITY);
      traced.occlusions({&shadow, 1});
      again += shadow.occluded();
    }
    EXPECT_GT(hits, 10000) << place;
    EXPECT_EQ(again, 0) << place;
  }
}

/// The middle of what is seen from (0, 0, 9), over E rho / pi, where the sun stands along `to_light`.
double cosine(const Text& shapes, const glm::dvec3& to_light) {
  const Text sun = emitter("directional", "<vector name='direction' value='" +
                                              point(-to_light.x, -to_light.y, -to_light.z) + "'/>" +
                                              spectrum("irradiance", "1"));
  RenderSpec spec;
  spec.xml = scene(2, perspective(lookat("0, 0, 9", "0, 0, 0"), 1, film(4)) + shapes + sun);
  spec.spp = 2;
  spec.sampling.replicates = 1;
  const RenderResult result = render(spec);
  EXPECT_EQ(result.invalid_samples, 0u);
  const double width = result.scene.channels[0].max_nm - result.scene.channels[0].min_nm;
  return result.at(2, 2, 0) * 3.14159265358979 / (0.5 * width);
}

// A square that is tilted by 45 degrees about y and then flattened along z has the normal (-1, 0, 1) with x and z in the inverse
// proportion; mirrors and groups in groups change nothing of which side is its front.
TEST(Instances, NormalsOfTiltedSquares) {
  const glm::dvec3 light = glm::normalize(glm::dvec3(0.8, 0.3, 0.9));
  const Text square = group("g", shape("rectangle", turn("y", "45"), diffuse("0.5")));
  const Text nested = square + group("outer", instance("g", scale(1, 1, 0.5)));
  const auto expected = [&](const glm::dvec3& normal) { return glm::dot(glm::normalize(normal), light); };
  EXPECT_NEAR(cosine(square + instance("g", scale(1, 1, 0.5)), light), expected({1, 0, 2}), 2e-6);
  EXPECT_NEAR(cosine(square + instance("g", scale(-1, 1, 0.5)), light), expected({-1, 0, 2}), 2e-6);
  EXPECT_NEAR(cosine(nested + instance("outer", scale(1, 1, 0.5)), light), expected({1, 0, 4}), 2e-6);
  EXPECT_NEAR(cosine(nested + instance("outer", scale(-1, 1, 0.5) + turn("z", "90")), light),
              expected({0, -1, 4}), 2e-6);
  EXPECT_EQ(cosine(square + instance("g", turn("y", "180")), light), 0);  // its back
}

// Convex bodies that stand alone reflect rho of a uniform sky: what is wrong in offsets, sides or normals takes some away.
TEST(Instances, ConvexBodiesUnderAUniformSky) {
  const Text cube = group("g", shape("cube", turn("x", "40") + turn("y", "30"), diffuse("0.5")));
  for (const Text& steps : {scale(1, 1, 0.02), scale(-1, 0.3, 1) + turn("z", "50")}) {
    RenderSpec spec;
    spec.xml = scene(
        2, perspective(lookat("0, 0, 9", "0, 0, 0"), 0.5, film(4)) + cube + instance("g", steps) + sky("1"));
    spec.spp = 4096;
    spec.sampling.replicates = 16;
    const RenderResult result = render(spec);
    const double width = result.scene.channels[0].max_nm - result.scene.channels[0].min_nm;
    const PixelMean found = mean_of_pixels(result);
    EXPECT_LT(std::sqrt(found.variance), 2e-3 * found.mean);
    EXPECT_LT(z_score(found.mean, 0.5 * width, found.variance), critical_t(1e-6, 1, 16));
  }
}

}  // namespace
}  // namespace kiloband::test::test_instances
