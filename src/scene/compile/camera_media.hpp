// Which media the camera stands in.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// Media + 1 whose shapes enclose the point, the outermost first, then zeros: as a path remembers them. A
/// point is inside if a ray from it leaves the medium's shapes more often than it enters them.
/// throws InputError  at `position`: inside more than KB_MEDIUM_DEPTH media
std::array<uint16_t, KB_MEDIUM_DEPTH> media_at(const FlatScene& scene, const glm::dvec3& point,
                                               const SourcePosition& position);

/// The media where camera rays begin. scene.media, interiors and shapes are complete.
/// throws InputError  where the near plane is partly inside one
std::array<uint16_t, KB_MEDIUM_DEPTH> media_at_camera(const FlatScene& scene, const Sensor& sensor);

}  // namespace kiloband
