// Environment emitters: constant radiance and lat-long maps. environment-inl.hpp has them over lanes, this is one lane.
// Densities are without the probability of selection.
//
// The map (emitter's local frame, +Y up): u = atan2(x, -z) / 2 pi mod 1, v = acos(y) / pi, as in Mitsuba 3.
// The emitter's to_world is a rotation or reflection (uniform scale does not matter).
// How maps are sampled: scene/compile/light/envmap_sampling.hpp.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/compile/flat_scene.hpp"
#include "shared/environment.h"

namespace kiloband::cpu {

/// Map coordinates of a world direction: u in [0, 1), v in [0, 1].
glm::vec2 envmap_coordinates(const KbEmitter& emitter, glm::vec3 direction);

/// Density at map coordinates for receivers of a facing [1/sr].
float envmap_density(const EnvmapSampling& sampling, glm::vec2 uv, uint32_t facing = KB_ALL_FACINGS);

/// Facing (shared/environment.h) of a receiver's normal, in the world.
uint32_t environment_facing(const KbEmitter& emitter, glm::vec3 normal);

}  // namespace kiloband::cpu
