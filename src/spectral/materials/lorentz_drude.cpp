#include "spectral/materials/lorentz_drude.hpp"

namespace kiloband {

// The principal square root of a number with imaginary part >= 0 has both parts >= 0.
std::complex<double> lorentz_drude_index(const LorentzDrude& model, double lambda_um) {
  const double e = kEvUm / lambda_um;
  const double p2 = model.plasma_ev * model.plasma_ev;
  std::complex<double> eps =
      1.0 - model.free_strength * p2 / (e * std::complex<double>(e, model.free_width_ev));
  for (const LorentzOscillator& o : model.oscillators)
    eps += o.strength * p2 / std::complex<double>(o.resonance_ev * o.resonance_ev - e * e, -e * o.width_ev);
  return std::sqrt(eps);
}

}  // namespace kiloband
