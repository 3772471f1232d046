// Spectrum: a real function of wavelength, in double precision; the form in which all spectral input is held.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kiloband {

/// Immutable and cheap to copy. Units are the user's: reflectance [1],
/// radiance [W m^-2 sr^-1 nm^-1], index [1].
class Spectrum {
 public:
  struct Range {
    double min_nm;
    double max_nm;
  };

  Spectrum();  // constant 0
  static Spectrum constant(double value);
  /// Piecewise linear through the points; 0 outside, or the end values if `extrapolate`.
  /// lambda_nm  strictly increasing, as many as values, at least 1
  /// throws InputError  otherwise, or if a number is not finite
  static Spectrum tabulated(std::vector<double> lambda_nm, std::vector<double> values,
                            bool extrapolate = false);
  /// Jakob-Hanika sigmoid: scale * S(c0 x^2 + c1 x + c2), x = clamp(lambda_nm, 360, 830). See rgb.hpp.
  static Spectrum sigmoid(const std::array<double, 3>& c, double scale);
  /// Planck's law times scale, W m^-2 sr^-1 nm^-1; 0 outside `range` if given (Mitsuba's `blackbody`).
  static Spectrum planck(double temperature_k, double scale, std::optional<Range> range = std::nullopt);
  static Spectrum product(const Spectrum& a, const Spectrum& b);
  Spectrum scaled(double factor) const;
  /// The same data with the end values continued outside (no effect where there is no table).
  Spectrum extrapolated() const;

  double operator()(double lambda_nm) const;
  /// out[i] = (*this)(lambda_nm[i]); lambda in any order.
  void evaluate(std::span<const double> lambda_nm, std::span<double> out) const;

  /// Least upper bound over [min_nm, max_nm] for tables and constants;
  /// for other kinds a bound within 1e-3 relative.
  double max_over(double min_nm, double max_nm) const;
  double min_over(double min_nm, double max_nm) const;
  /// Integral over [min_nm, max_nm]: exact for tables, relative error < 1e-9 otherwise.
  double integral(double min_nm, double max_nm) const;
  double mean(double min_nm, double max_nm) const { return integral(min_nm, max_nm) / (max_nm - min_nm); }

  bool is_constant() const;
  /// What planck() was given, if this is Planck's law (scaled or not):
  /// consumers evaluate it rather than tabulate it.
  struct PlanckParameters {
    double temperature_k;
    double scale;
    std::optional<Range> range;
  };
  std::optional<PlanckParameters> planck_parameters() const;
  /// Where data are given, if the spectrum has such a range (outside: 0, or continued if extrapolating).
  std::optional<Range> data_range() const;
  bool extrapolates() const;
  /// Knots of piecewise linear data in ascending order; empty for other kinds.
  std::span<const double> knots_nm() const;
  std::span<const double> knot_values() const;

  class Node;  // implementation, spectrum_node.hpp
  const Node& node() const { return *node_; }

 private:
  explicit Spectrum(std::shared_ptr<const Node> node);
  std::shared_ptr<const Node> node_;
};

/// A table with a regular step: value(lambda) = lerp at (lambda - min_nm) / step_nm;
/// outside 0 or the end value.
struct RegularTable {
  double min_nm = 0;
  double step_nm = 1;
  std::vector<double> values;  // at least 2
  bool extrapolate = false;
  double max_error = 0;  // bound of |table - spectrum| over the range that was asked for, absolute

  double operator()(double lambda_nm) const;
  /// Where it can be other than 0, nm. The last entry's wavelength may round to a hair beyond it.
  Spectrum::Range support() const;
};

struct ResampleOptions {
  double relative_error = 1e-4;        // of the spectrum's largest magnitude in the range
  std::size_t max_entries = 1u << 20;  // beyond: InputError
};

/// The coarsest of the tried regular tables that reproduces `spectrum` on [min_nm, max_nm] within the error
/// bound. Data that are already regular, or so nearly that this keeps the bound, are taken over (their own step,
/// whole data range clipped to the request). Discontinuities at the ends of the data stay sharp:
/// the table begins and ends where the data do.
RegularTable resample(const Spectrum& spectrum, double min_nm, double max_nm,
                      const ResampleOptions& options = {});

}  // namespace kiloband
