// Rays against analytic shapes on the device, which has no double,
// against src_cpu/geometry/shape_geometry.cpp, which has.
#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"
#include "support.hpp"
#include "tests/unit/src_cpu/light/test_scene.hpp"

namespace kiloband::test::shape_test {

using namespace cpu;
namespace {

const char* const kSource = R"(
#include "geometry/surface.clh"
__kernel void intersect(ARGS) {
  ITEM
  float t = -1.0f;
  out->u[0] = intersect_analytic(&scene.shapes[in->u[0]], VEC3(0), VEC3(3), in->f[6], in->f[7], &t);
  out->f[0] = t;
}
__kernel void surface(ARGS) {
  ITEM
  const SurfacePoint p = analytic_surface(&scene.shapes[in->u[0]], VEC3(0));
  PUT3(0, p.position); PUT3(3, p.normal); PUT3(6, p.tangent); out->f[9] = p.uv.x; out->f[10] = p.uv.y;
}
__kernel void area_point(ARGS) {
  ITEM
  const AreaPoint p = sample_analytic_area(&scene.shapes[in->u[0]], VEC2(0));
  PUT3(0, p.position); PUT3(3, p.normal); PUT3(6, p.own);
  const float2 uv = analytic_uv(scene.shapes[in->u[0]].type, p.own);
  out->f[9] = uv.x; out->f[10] = uv.y;
}
/* Leaves the surface at the point nearest to VEC3(0) in direction VEC3(3): distance of the shape, if found. */
__kernel void leave(ARGS) {
  ITEM
  __global const KbShape* shape = &scene.shapes[in->u[0]];
  const SurfacePoint p = analytic_surface(shape, VEC3(0));
  const float3 d = VEC3(3);
  const float3 origin = offset_ray_origin(p.position, dot(p.normal, d) >= 0.0f ? p.normal : -p.normal,
                                          surface_offset(shape_largest_coordinates(shape), p.normal));
  float t = -1.0f;
  out->u[0] = intersect_analytic(shape, origin, d, 0.0f, INFINITY, &t);
  out->f[0] = t; PUT3(1, origin); PUT3(4, p.position); PUT3(7, p.normal);
}
)";

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + kSource);
  return instance;
}

/// Spheres, disks and cylinders of `size`, centred `distance` sizes from the origin,
/// turned, mirrored, flipped.
FlatScene shapes_of(double size, double distance) {
  FlatScene scene;
  const glm::dvec3 centre = size * distance * glm::normalize(glm::dvec3(1, -2, 0.7));
  for (const double angle : {0.0, 0.8}) {
    for (const double mirror : {1.0, -1.0}) {
      for (const uint32_t flags : {0u, KB_SHAPE_FLIP_NORMALS}) {
        const glm::dvec3 scale = size * glm::dvec3(mirror, 1, 1);
        scene.shapes.push_back(make_shape(KB_SHAPE_SPHERE, placed(centre, angle, scale), flags));
        scene.shapes.push_back(make_shape(KB_SHAPE_DISK, placed(centre, angle, scale), flags));
        scene.shapes.push_back(
            make_shape(KB_SHAPE_CYLINDER, placed(centre, angle, scale * glm::dvec3(0.5, 0.5, 2)), flags));
      }
    }
  }
  return scene;
}

glm::dvec3 centre_of(const KbShape& shape) {
  return {shape.to_world[3], shape.to_world[7], shape.to_world[11]};
}

/// Rays from points up to `distance` sizes away towards points around the shape.
std::vector<ItemIn> rays_towards(const FlatScene& scene, double size, double distance, std::size_t count) {
  Random random(4);
  std::vector<ItemIn> in(count);
  for (ItemIn& item : in) {
    item.u[0] = random.index(static_cast<uint32_t>(scene.shapes.size()));
    const glm::dvec3 centre = centre_of(scene.shapes[item.u[0]]);
    const glm::vec3 origin(centre + random.direction() * (size * distance * random.unit()));
    const glm::dvec3 target = centre + random.direction() * (1.2 * size * std::cbrt(double(random.unit())));
    put(item, 0, origin);
    put(item, 3, glm::vec3(glm::normalize(target - glm::dvec3(origin))));
    item.f[7] = random.index(4) ? 3e38f : random.between(0, 2 * size * distance);
  }
  return in;
}

/// Hits within 1e-5 of the shape's size and 3e-7 of t, but for rays that graze: there the error of t is that
/// of the squared chord, 2e-7 size^2, over the chord.
void expect_hits(double size, double offset, double distance) {
  const FlatScene scene = shapes_of(size, offset);
  const std::vector<ItemIn> in = rays_towards(scene, size, distance, 100000);
  const std::vector<ItemOut> out = run_items(probe(), "intersect", scene, in);
  std::size_t parted = 0, hits = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    double t = 0;
    const bool found = intersect_analytic(scene.shapes[in[i].u[0]], get3(in[i], 0), get3(in[i], 3),
                                          in[i].f[6], in[i].f[7], t);
    if (found != (out[i].u[0] != 0)) {
      ++parted;
      continue;
    }
    if (!found) continue;
    ++hits;
    ASSERT_NEAR(out[i].f[0], t, 1e-5 * size + 3e-7 * t) << "shape " << in[i].u[0] << " ray " << i;
  }
  EXPECT_GT(hits, in.size() / 5);
  EXPECT_LE(parted, 3u) << "of rays, at the rims";
}

TEST(GpuShapes, HitsOfNearAndFarRays) {
  for (const double distance : {1.0, 5.0, 1000.0, 1e5}) expect_hits(1, 3, distance);
}
TEST(GpuShapes, HitsOfSmallAndLargeShapes) {
  for (const double size : {1e-6, 1e-3, 1e3, 1e6}) expect_hits(size, 2, 4);
}
TEST(GpuShapes, HitsFarFromTheOrigin) {
  expect_hits(1, 1e4, 5);
}

/// Leaving a shape in any direction never finds it where the ray starts:
/// what is found is what double precision finds.
void expect_clean_departure(double size, double offset) {
  const FlatScene scene = shapes_of(size, offset);
  Random random(5);
  std::vector<ItemIn> in(200000);
  for (ItemIn& item : in) {
    item.u[0] = random.index(static_cast<uint32_t>(scene.shapes.size()));
    const AreaPoint point = sample_analytic_area(scene.shapes[item.u[0]], {random.unit(), random.unit()});
    put(item, 0, point.position);
    glm::dvec3 d = random.direction();
    // A quarter of them graze the surface.
    if (random.index(4) == 0)
      d = glm::normalize(d - 0.999 * glm::dot(d, glm::dvec3(point.normal)) * glm::dvec3(point.normal));
    put(item, 3, glm::vec3(d));
  }
  const std::vector<ItemOut> out = run_items(probe(), "leave", scene, in);
  std::size_t parted = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const KbShape& shape = scene.shapes[in[i].u[0]];
    const glm::vec3 direction = get3(in[i], 3), origin = get3(out[i], 1);
    double t = 0;
    const bool found = intersect_analytic(shape, origin, direction, 0, HUGE_VAL, t);
    if (found != (out[i].u[0] != 0)) ++parted;
    // Towards the side that the ray goes to there is at most the other side of the shape: its chord is about
    // 2 size |cos| times the normal's cosine; a disk has no other side.
    const double cosine = std::fabs(glm::dot(direction, get3(out[i], 7)));
    if (out[i].u[0]) {
      ASSERT_NE(shape.type, uint32_t{KB_SHAPE_DISK}) << i;
      ASSERT_GT(out[i].f[0], 0.25 * size * cosine) << "shape " << in[i].u[0] << " item " << i;
      if (found) {
        ASSERT_NEAR(out[i].f[0], t, 2e-5 * size + 1e-6 * t) << i;
      }
    }
  }
  EXPECT_LE(parted, 3u) << "of rays, at the ends of cylinders";
}

TEST(GpuShapes, RaysDoNotHitTheSurfaceTheyLeave) {
  expect_clean_departure(1, 0);
  expect_clean_departure(1, 3);
  expect_clean_departure(1e-2, 100);
  expect_clean_departure(1e3, 1);  // the surface passes near the origin, where offsets are small
  expect_clean_departure(1e6, 1);
}

/// A sphere of the Earth's size below the origin: rays that leave it upwards find nothing, whatever their
/// slope, and rays from 2 m above it find the ground where double precision finds it.
TEST(GpuShapes, GroundOfPlanetSize) {
  FlatScene scene;
  scene.shapes.push_back(make_shape(KB_SHAPE_SPHERE, placed({0, -6.4e6, 0}, 0.3, glm::dvec3(6.4e6))));
  Random random(6);
  std::vector<ItemIn> up(50000), down(50000);
  for (std::size_t i = 0; i < up.size(); ++i) {
    put(up[i], 0, {random.between(-10, 10), 0, random.between(-10, 10)});
    glm::dvec3 d = random.direction();
    d.y = std::fabs(d.y) * (i % 2 ? 1 : 1e-3) + 1e-5;
    put(up[i], 3, glm::vec3(glm::normalize(d)));
    put(down[i], 0, {random.between(-10, 10), 2, random.between(-10, 10)});
    d.y = -d.y - 2e-3;
    put(down[i], 3, glm::vec3(glm::normalize(d)));
    down[i].f[7] = 1e9f;
  }
  for (const ItemOut& item : run_items(probe(), "leave", scene, up)) {
    ASSERT_EQ(item.u[0], 0u) << item.f[0];
    ASSERT_LT(std::fabs(glm::length(glm::dvec3(get3(item, 4)) + glm::dvec3(0, 6.4e6, 0)) - 6.4e6), 1.0);
  }
  const std::vector<ItemOut> ground = run_items(probe(), "intersect", scene, down);
  for (std::size_t i = 0; i < down.size(); ++i) {
    double t = 0;
    ASSERT_TRUE(intersect_analytic(scene.shapes[0], get3(down[i], 0), get3(down[i], 3), 0, 1e9, t));
    ASSERT_TRUE(ground[i].u[0]);
    ASSERT_LT(relative(ground[i].f[0], t), 1e-4) << t;
  }
}

TEST(GpuShapes, UnusableRaysMiss) {
  const FlatScene scene = shapes_of(1, 1);
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<ItemIn> in;
  for (uint32_t shape = 0; shape < scene.shapes.size(); ++shape) {
    for (const float x : {nan, inf, -inf}) {
      in.push_back({{x, 0, 0, 0, 0, 1, 0, 3e38f}, {shape}});
      in.push_back({{0, 0, 5, x, 0, -1, 0, 3e38f}, {shape}});
    }
    in.push_back({{0, 0, 5, 0, 0, 0, 0, 3e38f}, {shape}});
  }
  for (const ItemOut& item : run_items(probe(), "intersect", scene, in)) EXPECT_EQ(item.u[0], 0u);
}

/// Points near the surface: position to 2e-7 of the shape's size and one unit of its coordinates; normals,
/// tangents and uv to 2e-6 (tangents turn fast near poles and centres; uv likewise).
void expect_surface(double size, double offset) {
  const FlatScene scene = shapes_of(size, offset);
  Random random(7);
  std::vector<ItemIn> in(50000);
  for (ItemIn& item : in) {
    item.u[0] = random.index(static_cast<uint32_t>(scene.shapes.size()));
    const AreaPoint point = sample_analytic_area(scene.shapes[item.u[0]], {random.unit(), random.unit()});
    put(item, 0, point.position + glm::vec3(random.direction() * 1e-6 * size));
  }
  const std::vector<ItemOut> out = run_items(probe(), "surface", scene, in);
  const double ulp = size * (1 + offset) * 1.2e-7;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const KbShape& shape = scene.shapes[in[i].u[0]];
    const SurfacePoint expected = analytic_surface(shape, get3(in[i], 0));
    ASSERT_LT(difference(get3(out[i], 0), expected.position), ulp + 2e-7 * size) << i;
    ASSERT_LT(difference(get3(out[i], 3), expected.normal), 2e-6) << i;
    // How far from where the tangent is not defined.
    double margin = 1;
    if (shape.type == KB_SHAPE_SPHERE) margin = std::sin(3.14159265 * expected.uv.y);
    if (shape.type == KB_SHAPE_DISK) margin = expected.uv.x;
    if (margin < 1e-3) continue;
    ASSERT_LT(difference(get3(out[i], 6), expected.tangent), 2e-6 / margin) << i;
    const bool phi_first = shape.type != KB_SHAPE_DISK;
    ASSERT_LT(periodic(out[i].f[phi_first ? 9 : 10], phi_first ? expected.uv.x : expected.uv.y),
              1e-6 / margin);
    ASSERT_NEAR(out[i].f[phi_first ? 10 : 9], phi_first ? expected.uv.y : expected.uv.x, 2e-6);
  }
}

TEST(GpuShapes, SurfacePoints) {
  for (const double size : {1e-6, 1.0, 1e5}) {
    for (const double offset : {0.0, 5.0, 1e3}) expect_surface(size, offset);
  }
}

TEST(GpuShapes, AreaSamplesAreThoseOfTheCpu) {
  const FlatScene scene = shapes_of(2, 3);
  Random random(8);
  std::vector<ItemIn> in(50000);
  for (ItemIn& item : in)
    item = {{random.unit(), random.unit()}, {random.index(static_cast<uint32_t>(scene.shapes.size()))}};
  in[0].f[0] = in[0].f[1] = 0;
  const std::vector<ItemOut> out = run_items(probe(), "area_point", scene, in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const KbShape& shape = scene.shapes[in[i].u[0]];
    const AreaPoint expected = sample_analytic_area(shape, get2(in[i], 0));
    ASSERT_LT(difference(get3(out[i], 0), expected.position), 4e-6) << i;
    ASSERT_LT(difference(get3(out[i], 3), expected.normal), 2e-6) << i;
    const glm::vec2 uv = analytic_uv(shape.type, expected.local);
    const double margin = std::hypot(double(expected.local.x), double(expected.local.y));
    const bool disk = shape.type == KB_SHAPE_DISK;
    ASSERT_LT(periodic(out[i].f[disk ? 10 : 9], disk ? uv.y : uv.x), 1e-6 / margin + 1e-6);
    ASSERT_NEAR(out[i].f[disk ? 9 : 10], disk ? uv.x : uv.y, 2e-6);
  }
}

}  // namespace
}  // namespace kiloband::test::shape_test
