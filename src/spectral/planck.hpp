#pragma once

namespace kiloband {

/// h c / k in nm K: Planck's law has the exponent kPlanckSecond_nm_k / (lambda T). CODATA 2018, exact.
inline constexpr double kPlanckSecond_nm_k = 6.62607015e-34 * 299792458.0 / 1.380649e-23 * 1e9;

/// Planck's law: spectral radiance of a blackbody, W m^-2 sr^-1 nm^-1. CODATA 2018 (exact) constants.
/// lambda_nm > 0, temperature_k >= 0 (0 gives 0). Accurate (relative error < 1e-13) from 0.3 um at 200 K
/// (about 1e-96) to 20 um at 6000 K and in the Rayleigh-Jeans limit;
/// underflows to 0 in double only below 1e-300.
double planck_radiance(double lambda_nm, double temperature_k);

/// The same as a(lambda) exp(-x) / (1 - exp(-x)), x = b(lambda) / T: a in W m^-2 sr^-1 nm^-1, b in K.
struct PlanckTerms {
  double a, b;
};
PlanckTerms planck_terms(double lambda_nm);

/// Integral over [min_nm, max_nm], W m^-2 sr^-1, relative error < 1e-10 for any width (Gauss-Legendre in
/// ln(lambda)). 0 < min_nm <= max_nm, finite.
double planck_integral(double min_nm, double max_nm, double temperature_k);

}  // namespace kiloband
