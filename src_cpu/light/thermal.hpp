// What surfaces emit by Kirchhoff's law towards a direction.
#pragma once

#include <glm/glm.hpp>

#include "src_cpu/geometry/surface_hit.hpp"
#include "src_cpu/light/emitter.hpp"

namespace kiloband::cpu {

/// Radiance = weight * `radiance`, which is one of the emission spectra that KbThermal names, chosen by
/// random numbers so that the mean is eps(lambda, direction) B(lambda, T). A mask's opacity is in the weight.
/// 0: nothing is emitted
struct ThermalRadiance {
  float weight = 0;
  ResolvedSpectrum radiance;
};

/// hit      on a shape whose surface has KB_SURFACE_THERMAL
/// towards  unit vector, away from the surface
/// u        uniform in [0,1)^2
ThermalRadiance thermal_radiance(const FlatScene& scene, const SurfaceHit& hit, glm::vec3 towards,
                                 glm::vec2 u);

}  // namespace kiloband::cpu
