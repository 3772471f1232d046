// The spectra that paths refer to, as dense rows [spectrum][channel] at one wavelength offset mu.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"
#include "src_cpu/evaluate/rows.hpp"
#include "src_cpu/evaluate/texture/colour_cells.hpp"

namespace kiloband::cpu {

/// The values of a table for the kernels, which may be copies in another precision.
/// throws std::logic_error  fewer than 2
template <class Number>
TableView<Number> view_of(const std::vector<Number>& values, const RegularTable& table) {
  if (values.size() < 2) throw std::logic_error("dense spectra: a table has fewer than 2 entries");
  return {values.data(), values.size(), table.min_nm, table.step_nm, table.extrapolate};
}

/// Dense spectra of one wavelength offset mu: row s holds spectrum s at lambda_k = (1 - mu) min_k + mu max_k
/// for every channel, padded with zeros to a multiple of 64 floats and aligned to 64 bytes. Emission rows
/// hold radiance * width_k / channel_scale_k, so that path sums are channel values in film units.
///
/// Rows are made when they are first asked for and live until the next begin(). All are resampled in double,
/// except reflectances in the fast mode: those come from float copies of the tables by SIMD gathers
/// (positions in double).
class DenseSpectra {
 public:
  DenseSpectra(const FlatScene& scene, const EvaluatorKernels& kernels);

  /// Starts over with another offset in [0, 1].
  /// `fast`: see above (`per-path` makes every row anew for each path).
  void begin(double mu, bool fast);

  /// Row of spectrum s.
  /// throws std::logic_error  there is no such spectrum
  const float* spectrum(uint32_t s) { return lookup()(s); }

  struct Row {
    uint64_t generation = 0;
    float* data = nullptr;
  };
  /// spectrum() for loops that ask often: what it reads of this object stays in registers. Valid until begin().
  class Lookup {
   public:
    explicit Lookup(DenseSpectra& spectra)
        : rows_(spectra.rows_.data()),
          size_(spectra.rows_.size()),
          generation_(spectra.generation_),
          spectra_(spectra) {}

    const float* operator()(uint32_t s) const {
      if (s >= size_) throw_bad_row(s);
      return rows_[s].generation == generation_ ? rows_[s].data : spectra_.make_spectrum(s);
    }

   private:
    const Row* rows_;
    std::size_t size_;
    uint64_t generation_;
    DenseSpectra& spectra_;
  };
  Lookup lookup() { return Lookup(*this); }

  /// width_k / channel_scale_k: emission of 1 W m^-2 sr^-1 nm^-1.
  const float* unit_emission() const { return unit_emission_.get(); }
  double emission_factor(std::size_t channel) const { return emission_factor_[channel]; }
  /// Planck's law at a temperature that no row has, in film units, times `emissivity` (null: 1). Double
  /// precision, one exponential a channel (about 4 ns): the relative error is that of the stored float.
  /// out  padded_channels() floats
  void fill_planck(double temperature_k, const float* emissivity, float* out);
  std::size_t padded_channels() const { return padded_; }
  /// clamp(lambda_k, 360, 830) - KB_TEXTURE_CENTRE_NM, nm: where textures are evaluated. In the fast mode no channel is interpolated:
  /// a row of one path does not earn it.
  ColourOffsets texture_offsets();

  /// hc / (k lambda_k) in kelvin, 1 in the padding: what Planck's law at other temperatures needs.
  const float* planck_second();

  /// T = n^2 - 1 - k^2 as a sum of two floats, and n k, of a conductor; n k has a negative sign where metal_fresnel() would lose digits.
  std::array<const float*, 3> conductor(uint32_t material);
  /// E = e^2 - 1 as a sum of two floats, e - 1, and e / E^2 (1e30 at most), where e is the relative index of a dispersive dielectric:
  /// interior over exterior seen from outside, the reciprocal seen from `inside`.
  std::array<const float*, 4> dispersive(uint32_t material, bool inside);

  std::size_t channels() const { return channels_; }
  /// lambda_k in nm, padded with zeros.
  const double* lambda_nm() const { return lambda_.get(); }
  bool fast() const { return fast_; }
  double mu() const { return mu_; }
  uint64_t generation() const { return generation_; }

 private:
  struct PlanckRow {
    uint64_t generation = 0;
    std::vector<double> radiance;
  };
  struct MaterialRows {
    uint64_t generation[2] = {0, 0};  // conductor or outside; inside
    std::array<float*, 4> data[2] = {};
  };

  [[noreturn]] static void throw_bad_row(uint32_t s);
  const float* make_spectrum(uint32_t s);
  void fill_exact(uint32_t s, float* out);
  /// Values of a spectrum without units of the film, in double, in `out`. Returns them.
  const double* exact_values(uint32_t s, std::vector<double>& out) const;
  /// Planck's law in film units, shared by the emissivities of one temperature.
  const std::vector<double>& planck(double temperature_k);
  const std::vector<float>& float_table(uint32_t s);
  MaterialRows& material_rows(uint32_t material);

  const FlatScene& scene_;
  const EvaluatorKernels& kernels_;
  std::size_t channels_, padded_;
  double mu_ = -1;
  bool fast_ = false;
  uint64_t generation_ = 0;
  uint64_t texture_generation_ = 0, planck_generation_ = 0;
  std::vector<double> planck_a_, planck_b_;  // PlanckTerms in film units
  std::vector<double> min_nm_, max_nm_,
      emission_factor_;            // emission_factor: width_k / channel_scale_k, padded
  std::vector<bool> is_emission_;  // of a spectrum
  hwy::AlignedFreeUniquePtr<double[]> lambda_;
  hwy::AlignedFreeUniquePtr<float[]> texture_offsets_;
  std::size_t distinct_offsets_ = 0;
  ColourCellRows colour_cells_;
  const ColourCells* placed_cells_ = nullptr;
  uint64_t planck_second_generation_ = 0;
  hwy::AlignedFreeUniquePtr<float[]> unit_emission_, planck_second_;
  std::vector<Row> rows_;                         // by spectrum
  std::vector<MaterialRows> material_rows_;       // by material
  std::map<double, PlanckRow> planck_;            // by temperature
  std::vector<std::vector<float>> float_tables_;  // by spectrum, made when needed
  std::vector<double> optical_[2];                // indices of the material at hand
  RowPool pool_;  // padding is zero: rows are only ever written in their first K entries, or zeros beyond
};

}  // namespace kiloband::cpu
