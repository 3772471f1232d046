// The acceleration structure that kernels/geometry/bvh.clh traverses, built on the host.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"

namespace kiloband::opencl {

/// A bounding volume hierarchy over triangles, analytic shapes and instances. Node 0 is the root, and always an inner
/// node; nodes stand depth first, primitives in the order of their leaves. The trees of groups of meshes follow.
struct Bvh {
  std::vector<KbBvhNode> nodes;
  std::vector<KbPrimitive> primitives;  // without those that no ray can hit
  uint32_t depth = 0;                   // inner nodes on the longest way from a root to a leaf

  /// Entries that the stack of a tree's traversal needs at most: KB_BVH_STACK of the kernels. At each inner node it goes
  /// on with one child and keeps the others.
  uint32_t stack_entries() const { return depth * (KB_BVH_WIDTH - 1); }
};

/// Builds it with the surface area heuristic. The result depends on the scene alone, to the byte, whatever
/// the number of threads (0: all).
/// throws DeviceError  there is no memory, too many primitives, or Embree fails
Bvh build_bvh(const FlatScene& scene, int threads = 0);

}  // namespace kiloband::opencl
