// The camera's record. Internal to src/scene.
#pragma once

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// The camera with its filter, and the media in which its rays begin: those of the scene are complete.
void set_camera(FlatScene& scene, const Sensor& sensor);

}  // namespace kiloband
