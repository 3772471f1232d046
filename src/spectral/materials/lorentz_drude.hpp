// The Lorentz-Drude model of metals.
#pragma once

#include <complex>
#include <span>

namespace kiloband {

/// A bound electron: strength [1], resonance and width in eV.
struct LorentzOscillator {
  double strength, resonance_ev, width_ev;
};

/// Free electrons (strength, width) and oscillators, all in units of the plasma frequency squared. Unused
/// oscillators have strength 0.
struct LorentzDrude {
  double plasma_ev;
  double free_strength, free_width_ev;
  LorentzOscillator oscillators[5];
};

/// hc in eV um: a photon of wavelength l um has hc / l eV (CODATA 2018, exact).
inline constexpr double kEvUm = 1.23984198433;

/// n + ik, both >= 0. With E the photon energy and P the plasma energy,
///     eps(E) = 1 - f0 P^2 / (E (E + i G0)) + sum_j fj P^2 / (Ej^2 - E^2 - i E Gj),   n + ik = sqrt(eps)
/// source  Rakic, Djurisic, Elazar, Majewski: Optical properties of metallic films for vertical-cavity
///         optoelectronic devices. Appl. Opt. 37, 5271 (1998), equations 1 to 3
std::complex<double> lorentz_drude_index(const LorentzDrude& model, double lambda_um);

}  // namespace kiloband
