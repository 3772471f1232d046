// The dispersion formulas of refractiveindex.info.
#pragma once

#include <string>
#include <vector>

#include "spectral/spectrum.hpp"

namespace kiloband {

/// Refractive index by formula `number` (1 to 9) with the database's coefficients C1, C2 ...
/// (missing ones are 0).
/// lambda_um  wavelength in micrometres
/// returns    not a number where the formula has no real value
/// source     M. Polyanskiy, refractiveindex.info, "Dispersion formulas" (2014-06-29)
double dispersion_formula(int number, const std::vector<double>& coefficients, double lambda_um);

/// The largest number of coefficients that the formula has.
std::size_t max_coefficients(int number);

/// The formula as a table over [min_um, max_um] whose linear interpolation is off by less than 1e-6.
/// where  put in front of messages
/// throws InputError  where n is not positive and finite, or varies too fast for 2^18 points (a resonance
///                    inside the range)
Spectrum tabulate_formula(const std::string& where, int number, const std::vector<double>& coefficients,
                          double min_um, double max_um);

}  // namespace kiloband
