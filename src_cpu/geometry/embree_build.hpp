// The scene as Embree's geometries.
#pragma once

#include <embree3/rtcore.h>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// Geometry ids are indices of shapes; instances have that of their first shape, and the meshes in them count from 0, so
/// that both ids add up to the shape. The scene's arrays must outlive what is returned, which the caller releases.
/// throws DeviceError naming Embree's error
RTCScene build_embree_scene(RTCDevice device, const FlatScene& flat);

}  // namespace kiloband::cpu
