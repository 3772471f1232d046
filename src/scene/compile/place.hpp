// Where the scene stands, and where single precision can take it. Internal to src/scene.
#pragma once

#include <array>

#include "scene/compile/extent.hpp"
#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// throws InputError  places and sizes that single precision cannot take
void check_places(const SceneDescription& scene, GroupExtents& extents, const DiagnosticSink& sink);
/// throws InputError  a place or size that single precision cannot take
void check_camera_place(const Sensor& sensor);

/// FlatScene::origin: the middle of the shapes, where they are far from the file's origin.
std::array<double, 3> origin_of(const SceneDescription& scene, GroupExtents& extents);
/// Moved so that the origin, in the scene file's coordinates, is at 0.
Transform placed_at(const std::array<double, 3>& origin, const Transform& to_world);

}  // namespace kiloband
