#include "src_gpu/geometry/bvh_primitives.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "scene/compile/shape_bounds.hpp"

namespace kiloband::opencl {
namespace {

constexpr float kLargest = 1.844e18f;  // Embree drops what reaches farther: squares of lengths would overflow

Box triangle_box(const float* corner) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = corner[axis], b = corner[3 + axis], c = corner[6 + axis];
    box.low[axis] = std::min({a, b, c});
    box.high[axis] = std::max({a, b, c});
  }
  return box;
}

/// False for NaN, which minima and maxima may hide: `corner` is looked at as well.
bool usable(const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(box.low[axis] > -kLargest && box.high[axis] < kLargest && box.low[axis] <= box.high[axis]))
      return false;
  }
  return true;
}

bool equal_corners(const float* a, const float* b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bool can_be_hit(const float* corner) {
  for (int i = 0; i < 9; ++i) {
    if (!std::isfinite(corner[i])) return false;
  }
  return !equal_corners(corner, corner + 3) && !equal_corners(corner + 3, corner + 6) &&
         !equal_corners(corner + 6, corner);
}

KbPrimitive triangle_primitive(const FlatScene& scene, uint32_t shape, uint32_t triangle) {
  KbPrimitive primitive{};
  const std::size_t first = 3 * (std::size_t{scene.shapes[shape].first_triangle} + triangle);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const KbFloat3& position = scene.positions[scene.triangles[first + corner]];
    std::memcpy(&primitive.corner[3 * corner], &position, sizeof position);
  }
  primitive.shape = shape;
  primitive.primitive = triangle;
  primitive.analytic = KB_SHAPE_MESH;
  return primitive;
}

void collect_mesh(const FlatScene& scene, uint32_t shape, std::vector<KbPrimitive>& out) {
  for (uint32_t triangle = 0; triangle < scene.shapes[shape].triangle_count; ++triangle) {
    const KbPrimitive primitive = triangle_primitive(scene, shape, triangle);
    if (can_be_hit(primitive.corner) && usable(triangle_box(primitive.corner))) out.push_back(primitive);
  }
}

}  // namespace

Box primitive_box(const KbPrimitive& primitive, const FlatScene& scene) {
  if (primitive.analytic == KB_SHAPE_MESH) return triangle_box(primitive.corner);
  Box box;
  for (int axis = 0; axis < 3; ++axis)
    std::tie(box.low[axis], box.high[axis]) = analytic_interval(scene.shapes[primitive.shape], axis);
  return box;
}

std::vector<KbPrimitive> collect_primitives(const FlatScene& scene) {
  std::vector<KbPrimitive> primitives;
  primitives.reserve(scene.triangles.size() / 3 + scene.shapes.size());
  for (uint32_t id = 0; id < scene.shapes.size(); ++id) {
    if (scene.shapes[id].type == KB_SHAPE_MESH) {
      collect_mesh(scene, id, primitives);
      continue;
    }
    KbPrimitive primitive{};
    primitive.shape = id;
    primitive.analytic = scene.shapes[id].type;
    if (usable(primitive_box(primitive, scene))) primitives.push_back(primitive);
  }
  return primitives;
}

}  // namespace kiloband::opencl
