// The scene as Embree's geometries.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"

namespace kiloband::cpu {

/// The spheres, disks and cylinders, which are one geometry.
struct AnalyticShapes {
  explicit AnalyticShapes(const FlatScene& scene);
  const KbShape& shape(unsigned primitive) const { return flat.shapes[ids[primitive]]; }

  const FlatScene& flat;
  std::vector<uint32_t> ids;  // indices of shapes, rising
  std::vector<ShapeForm> forms;
};

/// What occlusion queries are asked with: null boundaries hide nothing, and note that they were met.
struct OcclusionContext {
  RTCIntersectContext embree;  // what Embree hands on: a pointer to this is one to the whole
  uint32_t* passes;            // by the rays' ids, or null: 1 where one was met
};

/// Geometry ids are indices of shapes (of the analytic ones, of the first; their hits have their own); instances have that of their first shape, and the meshes in them count from 0, so
/// that both ids add up to the shape. The scene's arrays and the analytic shapes must outlive what is returned, which the caller releases.
/// throws DeviceError naming Embree's error
RTCScene build_embree_scene(RTCDevice device, const FlatScene& flat, const AnalyticShapes& analytic);

}  // namespace kiloband::cpu
