#include "src_cpu/bsdf/conductor_bound.hpp"

#include <complex>

namespace kiloband {
namespace {

/// Index variations inside a channel may carry F a little over its values at the ends and the middle.
constexpr double kSlack = 1.002;

/// Unpolarised reflectance of a metal with index n + i k for light from air.
double fresnel_conductor(double cos_i, double n, double k) {
  const std::complex<double> eta(n, k);
  const std::complex<double> cos_t = std::sqrt(1.0 - (1 - cos_i * cos_i) / (eta * eta));
  const std::complex<double> s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const std::complex<double> p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return 0.5 * (std::norm(s) + std::norm(p));
}

}  // namespace

ConductorBound::ConductorBound(const FlatScene& scene, const KbMaterial& material) {
  nodes_.fill(0);
  const RegularTable& n = scene.spectra[material.eta_row].table;
  const RegularTable& k = scene.spectra[material.k_row].table;
  for (const ChannelList* list : {&scene.channels, &scene.guide}) {
    for (const Channel& channel : *list) {
      for (const double lambda_nm : {channel.min_nm, channel.centre_nm(), channel.max_nm}) {
        const double n_here = n(lambda_nm), k_here = k(lambda_nm);
        for (int i = 0; i <= kCells; ++i) {
          const double f = fresnel_conductor(static_cast<double>(i) / kCells, n_here, k_here);
          // An index of 0 makes 0 / 0 at grazing incidence: everything is reflected there.
          nodes_[i] = std::max(nodes_[i], static_cast<float>(f <= 1 ? std::min(1.0, kSlack * f) : 1.0));
        }
      }
    }
  }
}

}  // namespace kiloband
