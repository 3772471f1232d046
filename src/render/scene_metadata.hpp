// What a cube's header says of its scene, so that figures can be computed from the cube alone.
#pragma once

#include <string>

#include "post/camera_geometry.hpp"
#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// The camera, with the film's crop window as the cube.
CameraGeometry camera_geometry(const FlatScene& scene);

/// Shapes that have an id, as "0 body, 2 nozzle": what the numbers of the auxiliary image `object` mean.
/// Commas and % in names are written as %XX.
std::string object_names(const FlatScene& scene);

}  // namespace kiloband
