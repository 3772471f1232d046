// How much light the rough coating of a plastic lets through.
#pragma once

#include <vector>

#include "shared/material_tables.h"

namespace kiloband {

/// The quantities and their resolution are Mitsuba 3's. The mean is a rectangle rule with both ends, about 1.5 %
/// below the integral; it is kept since images are to agree with Mitsuba's and energy stays conserved.
struct Coating {
  std::vector<float> transmittance;  // from outside, single scattering, at KB_COAT_NODES cosines
  double internal_reflectance = 0;   // 2 mean(R(mu) mu) over KB_COAT_NODES equidistant cosines, from inside
};

/// Reads the distribution, alpha_u (the model is isotropic) and eta of a rough plastic. Errors below 2e-5
/// (facet_quadrature.hpp). Takes some tens of milliseconds.
Coating make_coating(const KbMaterial& material);

}  // namespace kiloband
