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

/// id: what the primitive says of the shape
KbPrimitive triangle_primitive(const FlatScene& scene, uint32_t shape, uint32_t id, uint32_t triangle) {
  KbPrimitive primitive{};
  const std::size_t first = 3 * (std::size_t{scene.shapes[shape].first_triangle} + triangle);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const KbFloat3& position = scene.positions[scene.triangles[first + corner]];
    std::memcpy(&primitive.corner[3 * corner], &position, sizeof position);
  }
  primitive.shape = id;
  primitive.primitive = triangle;
  primitive.analytic = KB_SHAPE_MESH;
  return primitive;
}

void collect_mesh(const FlatScene& scene, uint32_t shape, uint32_t id, std::vector<KbPrimitive>& out) {
  for (uint32_t triangle = 0; triangle < scene.shapes[shape].triangle_count; ++triangle) {
    const KbPrimitive primitive = triangle_primitive(scene, shape, id, triangle);
    if (can_be_hit(primitive.corner) && usable(triangle_box(primitive.corner))) out.push_back(primitive);
  }
}

/// The box of the corners of `own` under a shape's to_world. Rays reach the group by to_object, and its hits are brought
/// back: the box is grown by what both may be wrong by.
Box instance_box(const KbShape& shape, const Box& own) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const float* row = &shape.to_world[4 * axis];
    double low = row[3], high = row[3], reach = std::abs(double{row[3]});
    for (int i = 0; i < 3; ++i) {
      const double a = double{row[i]} * double{own.low[i]}, b = double{row[i]} * double{own.high[i]};
      low += std::min(a, b);
      high += std::max(a, b);
      reach += std::max(std::abs(a), std::abs(b));
    }
    const double slack = 1e-5 * reach;
    box.low[axis] = static_cast<float>(low - slack);
    box.high[axis] = static_cast<float>(high + slack);
  }
  return box;
}

}  // namespace

Box primitive_box(const KbPrimitive& primitive, const FlatScene& scene, const std::vector<Box>& boxes) {
  if (primitive.analytic == KB_SHAPE_MESH) return triangle_box(primitive.corner);
  const KbShape& shape = scene.shapes[primitive.shape];
  if (primitive.analytic == KB_PRIMITIVE_INSTANCE) return instance_box(shape, boxes[primitive.primitive]);
  Box box;
  for (int axis = 0; axis < 3; ++axis)
    std::tie(box.low[axis], box.high[axis]) = analytic_interval(shape, axis);
  return box;
}

std::vector<KbPrimitive> collect_primitives(const FlatScene& scene, const std::vector<Box>& boxes) {
  std::vector<KbPrimitive> primitives;
  primitives.reserve(scene.triangles.size() / 3 + scene.shapes.size());
  const auto add = [&](uint32_t shape, uint32_t number, uint32_t kind) {
    KbPrimitive primitive{};
    primitive.shape = shape;
    primitive.primitive = number;
    primitive.analytic = kind;
    if (usable(primitive_box(primitive, scene, boxes))) primitives.push_back(primitive);
  };
  for (uint32_t id = 0; id < scene.shapes.size(); ++id) {
    const KbShape& shape = scene.shapes[id];
    if (shape.flags & KB_SHAPE_INSTANCED) continue;
    if (shape.type == KB_SHAPE_MESH)
      collect_mesh(scene, id, id, primitives);
    else
      add(id, 0, shape.type);
  }
  for (const MeshInstance& instance : scene.instances)
    add(instance.first_shape, instance.group, KB_PRIMITIVE_INSTANCE);
  return primitives;
}

std::vector<KbPrimitive> collect_group(const FlatScene& scene, const MeshGroup& group) {
  std::vector<KbPrimitive> primitives;
  for (uint32_t i = 0; i < group.shape_count; ++i) collect_mesh(scene, group.first_shape + i, i, primitives);
  return primitives;
}

}  // namespace kiloband::opencl
