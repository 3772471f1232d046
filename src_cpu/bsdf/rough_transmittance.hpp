// How much light a rough dielectric boundary lets through: tables that the rough plastic needs.
#pragma once

#include <algorithm>
#include <array>

#include "shared/records.h"

namespace kiloband {

/// Of one rough plastic; callers hold it beside the material (about 260 bytes).
///
/// The quantities and their resolution are Mitsuba 3's: transmittance from outside at 64 equidistant cosines,
/// interpolated linearly, and the diffuse reflectance from inside, 2 * mean(R(mu) mu) over 64 equidistant
/// cosines. That mean is a rectangle rule with both ends, so it lies about 1.5 % below the integral; it is
/// kept since images are to agree with Mitsuba's and energy stays conserved.
struct RoughTransmittance {
  static constexpr int kNodes = 64;
  std::array<float, kNodes>
      external{};                  // transmitted fraction at cos = i / 63, single scattering, from outside
  float internal_reflectance = 0;  // replaces KbMaterial::fdr_int

  /// cos in [0, 1]
  float transmittance(float cos_theta) const {
    const float x = std::clamp(cos_theta, 0.0f, 1.0f) * (kNodes - 1);
    const int i = std::min(static_cast<int>(x), kNodes - 2);
    const float t = x - static_cast<float>(i);
    return external[i] + t * (external[i + 1] - external[i]);
  }
};

/// Reads distribution, alpha_u (the model is isotropic) and eta. Takes tens of milliseconds.
/// A nonlinear rough plastic is evaluated with KbMaterial::fdr_int: whoever renders must
/// store internal_reflectance there.
RoughTransmittance make_rough_transmittance(const KbMaterial& material);

}  // namespace kiloband
