// How much light a rough dielectric boundary lets through: what a rough plastic's coating needs.
#pragma once

#include <vector>

#include "shared/records.h"

namespace kiloband::gpu {

struct RoughTransmittance {
  std::vector<float>
      external;  // fraction transmitted from outside in single scattering, 64 equidistant cosines
  float internal_reflectance = 0;  // 2 mean(R(mu) mu) over 64 equidistant cosines, both ends included, inside
};

/// Reads distribution, alpha_u (the model is isotropic) and eta. The quantities and their resolution are
/// Mitsuba 3's; the mean's rectangle rule, about 1.5 % below the integral, is its too.
RoughTransmittance make_rough_transmittance(const KbMaterial& material);

}  // namespace kiloband::gpu
