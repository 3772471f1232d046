// Directional emissivity of metals, eps = 1 - rho_dh of exactly the BSDF that is rendered, as spectra at
// nodes of a table of directions.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "scene/optics/facet_quadrature.hpp"
#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// n, k and the factor on the reflectance.
struct MetalSpectra {
  const RegularTable &n, &k, &tint;
};

/// With A(c) the absorptance 1 - F of a facet at the cosine c, a the mean of A over what the lobe reflects
/// (0 to E, the lobe's albedo for F = 1) and A0 = A(1):
///   smooth  eps = A(c)
///   rough   eps = 1 - (E - a) (1 + (1 - A0) (1 - E) / E) = a / E + A0 (1 - E) (1 - a / E),
///           energy-compensated,
/// and with a factor t on the reflectance, 1 - t + t eps.
///
/// Interpolated linearly in the cosine between nodes, the emissivity is off by 1e-4 at most and, where it
/// exceeds 1e-3, by 1e-3 of itself, at cosines above 1e-3. Nodes crowd towards grazing directions, where the
/// emissivity of metals has a narrow maximum in the infrared. Anisotropic roughness: also in
/// s = alpha_v y^2 / (alpha_u x^2 + alpha_v y^2), between at most 17 nodes, which keep those bounds for
/// ratios of the roughnesses up to 4; at 10 errors are up to 4 times larger (0.01 x 0.1 seen at grazing angles: 15
/// times), 7e-4 at 20, 5e-3 at 100, 6e-2 at 300, for n = 1.5, k = 2. Four times as many nodes would divide these by 4 to
/// 8 only, and multiply the spectra, 2,000 at such ratios, of which each is evaluated in all channels.
class MetalEmissivity {
 public:
  /// facets: absent for a smooth metal. range: of wavelengths
  MetalEmissivity(const MetalSpectra& spectra, const std::optional<Facets>& facets, const Channel& range);
  ~MetalEmissivity();

  const std::vector<double>& cosines() const { return cosines_; }  // ascending, 0 to 1
  uint32_t nodes_s() const { return nodes_s_; }
  /// By s, then cosine.
  std::vector<RegularTable> rows() const;
  /// t F0: the factor of the compensating part.
  RegularTable normal_reflectance() const;

 private:
  class Directions;

  std::vector<double> at(double cosine, double s) const;
  bool refine(double from, double to, int depth);
  void choose_nodes_s();
  std::vector<const std::vector<double>*> weights_of_rows() const;
  std::vector<std::vector<double>> rough_rows() const;
  std::vector<std::vector<double>> smooth_rows() const;
  RegularTable tabulate(const std::vector<double>& values) const;

  std::vector<double> lambda_nm_, n_, k_, tint_;  // regular
  std::vector<std::size_t> probes_;               // wavelengths that decide on nodes
  std::vector<std::vector<double>>
      absorptances_;  // of a rough metal at the probes, by the cells of facet cosines
  std::unique_ptr<Directions> directions_;
  std::vector<double> cosines_;
  uint32_t nodes_s_ = 1;
};

}  // namespace kiloband
