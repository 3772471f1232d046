// What goes into the acceleration structure: the scene's triangles and analytic shapes with their boxes.
#pragma once

#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"

namespace kiloband::opencl {

/// An axis-aligned box, m. Empty if low > high.
struct Box {
  float low[3], high[3];
};

/// The primitives of the scene itself, in its order, without those that no ray can hit: triangles with two equal
/// corners (their edge functions are exactly +x, -x and 0) and, as on the CPU, boxes that are not finite or
/// beyond 1.8e18 m. Instances follow, with the number of their group in place of its root.
/// boxes: of groups
std::vector<KbPrimitive> collect_primitives(const FlatScene& scene, const std::vector<Box>& boxes);
/// The same of a group of meshes, in its own coordinates.
std::vector<KbPrimitive> collect_group(const FlatScene& scene, const MeshGroup& group);

/// Box of a primitive: a triangle's is exact, an analytic shape's and an instance's are grown by their rounding errors.
Box primitive_box(const KbPrimitive& primitive, const FlatScene& scene, const std::vector<Box>& boxes);

}  // namespace kiloband::opencl
