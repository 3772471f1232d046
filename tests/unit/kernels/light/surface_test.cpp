// Surface hits, frames and ray offsets on the device against src_cpu/geometry/surface_hit.cpp and ray_offset.hpp.
#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"
#include "src_cpu/geometry/surface_hit.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
#include "support.hpp"
#include "tests/unit/src_cpu/light/test_scene.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/geometry/surface_hit-inl.hpp"

namespace kiloband::test::surface_test {

using namespace cpu;
namespace {

const char* const kSource = R"(
#include "geometry/surface.clh"
__kernel void hit(ARGS, __global const KbPrimitive* restrict primitives) {
  ITEM
  const Hit h = make_hit(in->f[6], in->f[7], in->f[8], in->u[0]);
  const SurfaceHit s = make_surface_hit(&scene, &primitives[h.primitive], h, VEC3(0), VEC3(3));
  PUT3(0, s.point); PUT3(3, s.geometric_normal); PUT3(6, s.shading_normal); PUT3(9, s.tangent);
  out->f[12] = s.uv.x; out->f[13] = s.uv.y; out->u[0] = s.shape;
  PUT3(14, leave_surface(&s, VEC3(3)));
  out->f[17] = s.offset;
}
__kernel void frame(ARGS) {
  ITEM
  const ShadingFrame f = make_frame(VEC3(0), VEC3(3));
  PUT3(0, f.x); PUT3(3, f.y); PUT3(6, f.z);
  const float3 own = to_local(&f, VEC3(6));
  PUT3(9, own); PUT3(12, to_world(&f, own));
}
__kernel void offset(ARGS) {
  ITEM
  PUT3(0, offset_ray_origin(VEC3(0), VEC3(3), target_offset(surface_offset(fabs(VEC3(0)), VEC3(3)), VEC3(3))));
}
)";

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + kSource);
  return instance;
}

/// Meshes with and without normals, uvs, flipped normals and mirroring, of several sizes;
/// then analytic shapes.
FlatScene surface_scene() {
  FlatScene scene;
  Random random(9);
  for (uint32_t flags = 0; flags < 16; ++flags) {
    KbShape shape{};
    shape.type = KB_SHAPE_MESH;
    shape.flags = (flags & 7) | (flags & 8 ? KB_SHAPE_MIRRORED : 0);
    shape.first_triangle = static_cast<uint32_t>(scene.triangles.size() / 3);
    shape.triangle_count = 20;
    const double size = flags == 3 ? 1e-7 : flags == 5 ? 1e4 : 1;
    for (uint32_t i = 0; i < 3 * shape.triangle_count; ++i) {
      scene.triangles.push_back(static_cast<uint32_t>(scene.positions.size()));
      const glm::vec3 p(random.direction() * size), n(random.direction());
      scene.positions.push_back({p.x, p.y, p.z});
      scene.normals.push_back({n.x, n.y, n.z});
      scene.uvs.push_back({random.unit(), random.unit()});
    }
    scene.shapes.push_back(shape);
  }
  // Degenerate: no normals at its corners, the same uv at all.
  for (int i = 0; i < 3; ++i) {
    scene.normals[i] = {0, 0, 0};
    scene.uvs[60 * 4 + i] = {0.5f, 0.5f};
  }
  for (const uint32_t type : {KB_SHAPE_SPHERE, KB_SHAPE_DISK, KB_SHAPE_CYLINDER}) {
    for (const uint32_t flags : {0u, KB_SHAPE_FLIP_NORMALS})
      scene.shapes.push_back(make_shape(type, placed({1, 2, 3}, 0.7, glm::dvec3(0.5)), flags));
  }
  return scene;
}

/// A hit from 2 m away: of a triangle by barycentric coordinates, of an analytic shape by t
/// (rounded, as hits are).
ItemIn hit_of(const FlatScene& scene, const std::vector<KbPrimitive>& primitives, uint32_t index,
              Random& random) {
  ItemIn item{};
  item.u[0] = index;
  const float a = random.unit(), b = random.unit();
  item.f[7] = a + b < 1 ? a : 1 - a;
  item.f[8] = a + b < 1 ? b : 1 - b;
  put(item, 3, glm::vec3(random.direction()));
  if (primitives[index].analytic == KB_SHAPE_MESH) return item;
  const AreaPoint point = sample_analytic_area(scene.shapes[primitives[index].shape], {a, b});
  const glm::vec3 origin(glm::dvec3(point.position) - 2.0 * glm::dvec3(get3(item, 3)));
  put(item, 0, origin);
  item.f[6] = glm::length(point.position - origin);
  return item;
}

TEST(GpuSurface, HitsOfMeshesAndShapes) {
  const FlatScene scene = surface_scene();
  const std::vector<KbPrimitive> primitives = primitives_of(scene);
  Random random(10);
  std::vector<ItemIn> in;
  for (int i = 0; i < 40000; ++i)
    in.push_back(hit_of(scene, primitives, random.index(static_cast<uint32_t>(primitives.size())), random));
  const std::vector<ItemOut> out = run_items(probe(), "hit", scene, in, primitives);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const KbPrimitive& p = primitives[in[i].u[0]];
    const SurfaceHit expected = make_surface_hit(scene, p.shape, p.primitive, in[i].f[7], in[i].f[8],
                                                 get3(in[i], 0), get3(in[i], 3), in[i].f[6]);
    const bool mesh = p.analytic == KB_SHAPE_MESH;
    const double size = mesh ? glm::length(expected.point) + 1e-8 : 4;
    ASSERT_EQ(out[i].u[0], expected.shape);
    ASSERT_LT(difference(get3(out[i], 0), expected.point), mesh ? 1e-12 * size : 3e-7 * size) << i;
    ASSERT_LT(difference(get3(out[i], 3), expected.geometric_normal), 2e-6) << i;
    ASSERT_LT(difference(get3(out[i], 6), expected.shading_normal), 2e-6) << i;
    const double margin = mesh ? 1 : 1e-2;  // near poles and centres tangents turn fast
    const double tangent = glm::length(expected.tangent);
    if (mesh || (expected.uv.x > margin && expected.uv.y > margin && expected.uv.y < 1 - margin)) {
      ASSERT_LE(difference(get3(out[i], 9), expected.tangent), 1e-5 / margin * tangent) << i;
      ASSERT_LT(difference(get2(out[i], 12), expected.uv), mesh ? 1e-6 : 1e-5) << i;
    }
    const float side = glm::dot(expected.geometric_normal, get3(in[i], 3));
    if (mesh && std::fabs(side) > 1e-5f) {
      const glm::vec3 n = side >= 0 ? get3(out[i], 3) : -get3(out[i], 3);
      // A point that was moved off an edge: a device's dot products may round less often. That is a unit of the last place, half
      // of the least offset.
      const bool moved = expected.departure != expected.point;
      const glm::vec3 origin = offset_ray_origin(expected.departure, n, out[i].f[17]);
      ASSERT_LE(difference(get3(out[i], 14), origin), moved ? 0x1p-23 * size : 0) << i;
      // The offset goes with the normal: bit for bit where both have the same one.
      const bool same_normal = get3(out[i], 3) == expected.geometric_normal;
      ASSERT_LE(relative(out[i].f[17], expected.offset), same_normal ? 0 : 2e-6) << i;
    }
  }
}

TEST(GpuSurface, Frames) {
  Random random(11);
  std::vector<ItemIn> in(20000);
  for (std::size_t i = 0; i < in.size(); ++i) {
    put(in[i], 0, i == 0 ? glm::vec3(0, 0, -1) : i == 1 ? glm::vec3(0, 0, 1) : glm::vec3(random.direction()));
    if (i % 3) put(in[i], 3, glm::vec3(random.direction() * double(random.between(0.1, 10))));
    if (i % 6 == 5) put(in[i], 3, get3(in[i], 0) * 3.0f);  // along the normal: of no use
    put(in[i], 6, glm::vec3(random.direction()));
  }
  const std::vector<ItemOut> out = run_items(probe(), "frame", FlatScene(), in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const one_lane::Frame expected = one_lane::make_frame(to_lane(get3(in[i], 0)), to_lane(get3(in[i], 3)));
    const double tolerance =
        i % 3 == 0 || i % 6 == 5 ? 2e-6 : 1e-4;  // tangents may be nearly along the normal
    ASSERT_LT(std::fabs(glm::dot(get3(out[i], 0), get3(out[i], 6))), 2e-4f) << i;
    ASSERT_LT(difference(get3(out[i], 0), to_glm(expected.x)), tolerance) << i;
    ASSERT_LT(difference(get3(out[i], 3), to_glm(expected.y)), tolerance) << i;
    ASSERT_EQ(get3(out[i], 6), to_glm(expected.z));
    const glm::vec3 local = to_glm(expected.to_local(to_lane(get3(in[i], 6))));
    ASSERT_LT(difference(get3(out[i], 9), local), tolerance) << i;
    ASSERT_LT(difference(get3(out[i], 12), get3(in[i], 6)), 2 * tolerance) << i;
  }
}

TEST(GpuSurface, OffsetsAreThoseOfTheCpuBitForBit) {
  Random random(12);
  std::vector<ItemIn> in(50000);
  for (ItemIn& item : in) {
    const double size = std::exp2(random.between(-12, 20));
    put(item, 0, glm::vec3(random.direction() * size));
    put(item, 3, glm::vec3(random.direction()));
  }
  in[0].f[0] = -0.0f;
  const std::vector<ItemOut> out = run_items(probe(), "offset", FlatScene(), in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::vec3 p = get3(in[i], 0), n = get3(in[i], 3);
    ASSERT_EQ(get3(out[i], 0), offset_ray_origin(p, n, target_offset(surface_offset(glm::abs(p), n), n)))
        << i;
  }
}

}  // namespace
}  // namespace kiloband::test::surface_test
