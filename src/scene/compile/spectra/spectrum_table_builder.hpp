// Builds the spectrum table of a FlatScene: one row per distinct spectrum,
// with checks against the rendered channels.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// Where a spectrum stands in the scene, for rows' names and messages.
struct SpectrumSource {
  std::string name;  // "bsdf 'wall': reflectance"
  SourcePosition position;
  bool emission = false;
};

class SpectrumTableBuilder {
 public:
  SpectrumTableBuilder(FlatScene& scene, const DiagnosticSink& sink);

  /// Row index of the spectrum; equal constants of the same kind share a row.
  /// throws InputError  the table would pass 65535 rows, or the spectrum cannot be tabulated within its bound
  uint32_t row(const Spectrum& spectrum, const SpectrumSource& use);

  /// A row of the spectrum's own: rows made one after the other have consecutive indices.
  /// throws as row()
  uint32_t new_row(const Spectrum& spectrum, const SpectrumSource& use);
  /// Warns if data do not cover guide bands and channels. data: absent if there is no limit
  void check_range(const std::optional<Spectrum::Range>& data, bool extrapolates,
                   const SpectrumSource& use) const;
  /// A row that is no input spectrum.
  /// throws as row()
  uint32_t add(SpectrumRow row, const SourcePosition& position = {});
  /// All wavelengths that rows must reach.
  const Channel& range() const { return range_; }
  /// Row of a gas's absorption coefficient, by its very knots (SpectrumRow::absorption).
  /// throws InputError  as row()
  uint32_t absorption_row(const Spectrum& spectrum, GasSpectrum treatment, const SpectrumSource& use);

  /// Mean over the guide bands (each band one vote).
  double guide_mean(const Spectrum& spectrum) const;
  /// Upper bound over guide bands and rendered channels.
  double bound(const Spectrum& spectrum) const;

 private:
  SpectrumRow make_row(const Spectrum& spectrum, const SpectrumSource& use) const;

  FlatScene& scene_;
  const DiagnosticSink& sink_;
  Channel range_;  // hull of guide bands and channels
  std::map<std::pair<double, bool>, uint32_t> constants_;
};

}  // namespace kiloband
