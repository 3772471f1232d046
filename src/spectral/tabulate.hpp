// A smooth function of wavelength as a table whose linear interpolation keeps to an error bound.
#pragma once

#include <functional>

#include "spectral/spectrum.hpp"

namespace kiloband {

/// The interpolation may miss a value v by absolute + relative * |v|.
struct TabulationError {
  double absolute = 0;
  double relative = 0;
};

/// Table of `value` (of the wavelength in micrometres) over [min_um, max_um], min_um < max_um.
/// value     smooth; may throw where it has no value
/// too_fast  is called with a wavelength where 2^18 points do not suffice, and must throw
Spectrum tabulate_function(const std::function<double(double)>& value, double min_um, double max_um,
                           const TabulationError& error, const std::function<void(double)>& too_fast);

}  // namespace kiloband
