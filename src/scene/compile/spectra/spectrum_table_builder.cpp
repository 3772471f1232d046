#include "scene/compile/spectra/spectrum_table_builder.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kiloband {
namespace {

constexpr std::size_t kMaxRows = 65535;
// Tables reproduce their spectra to this fraction of the largest value; coarser bounds are tried when a table
// would become too large (irregular data over a wide range), with a note.
constexpr double kErrorBounds[] = {1e-5, 1e-4, 1e-3};

Channel joint_hull(const ChannelList& a, const ChannelList& b) {
  const Channel first = hull(a);
  const Channel second = hull(b);
  return {std::min(first.min_nm, second.min_nm), std::max(first.max_nm, second.max_nm), ""};
}

}  // namespace

SpectrumTableBuilder::SpectrumTableBuilder(FlatScene& scene, const DiagnosticSink& sink)
    : scene_(scene), sink_(sink), range_(joint_hull(scene.channels, scene.guide)) {}

uint32_t SpectrumTableBuilder::row(const Spectrum& spectrum, const SpectrumSource& use) {
  const std::pair<double, bool> key{spectrum(range_.centre_nm()), use.emission};
  if (spectrum.is_constant()) {
    if (const auto found = constants_.find(key); found != constants_.end()) return found->second;
  }
  const uint32_t index = new_row(spectrum, use);
  if (spectrum.is_constant()) constants_[key] = index;
  return index;
}

uint32_t SpectrumTableBuilder::new_row(const Spectrum& spectrum, const SpectrumSource& use) {
  check_range(spectrum.data_range(), spectrum.extrapolates(), use);
  SpectrumRow made = make_row(spectrum, use);
  made.bound = static_cast<float>(bound(spectrum));
  return add(std::move(made), use.position);
}

uint32_t SpectrumTableBuilder::absorption_row(const Spectrum& spectrum, GasSpectrum treatment,
                                              const SpectrumSource& use) {
  check_range(spectrum.data_range(), spectrum.extrapolates(), use);
  SpectrumRow row;
  row.name = use.name;
  ChannelKnots knots = sampled_knots(spectrum, scene_.channels, use.name);
  if (treatment == GasSpectrum::kCorrelatedK) knots = sorted_knots(knots);
  row.absorption = std::make_shared<const ChannelKnots>(std::move(knots));
  row.bound = static_cast<float>(bound(spectrum));
  return add(std::move(row), use.position);
}

uint32_t SpectrumTableBuilder::add(SpectrumRow row, const SourcePosition& position) {
  if (scene_.spectra.size() >= kMaxRows)
    throw InputError(position, fmt::format("{}: more than {} different spectra", row.name, kMaxRows));
  scene_.spectra.push_back(std::move(row));
  return static_cast<uint32_t>(scene_.spectra.size() - 1);
}

SpectrumRow SpectrumTableBuilder::make_row(const Spectrum& spectrum, const SpectrumSource& use) const {
  SpectrumRow row;
  row.name = use.name;
  row.is_emission = use.emission;
  // Of what is no emission (an index of refraction) a table is read, whatever it is made of.
  if (const auto planck = spectrum.planck_parameters(); planck && use.emission) {
    row.is_planck = true;
    row.temperature_k = planck->temperature_k;
    row.planck_scale = planck->scale;
    if (planck->range) {
      row.planck_min_nm = planck->range->min_nm;
      row.planck_max_nm = planck->range->max_nm;
    }
    return row;
  }
  for (const double bound : kErrorBounds) {
    try {
      row.table = resample(spectrum, range_.min_nm, range_.max_nm, {.relative_error = bound});
      if (bound > kErrorBounds[0]) {
        note(sink_, use.position,
             fmt::format("{}: tabulated with a relative error bound of {}", use.name, bound));
      }
      return row;
    } catch (const InputError&) {
      if (bound == kErrorBounds[2]) throw;
    }
  }
  return row;
}

void SpectrumTableBuilder::check_range(const std::optional<Spectrum::Range>& data, bool extrapolates,
                                       const SpectrumSource& use) const {
  if (!data) return;
  constexpr double kSlackNm = 1e-6;
  if (data->min_nm <= range_.min_nm + kSlackNm && data->max_nm >= range_.max_nm - kSlackNm) return;
  warn(sink_, use.position,
       fmt::format("{}: data from {:g} to {:g} nm do not cover {:g} to {:g} nm; outside, {}", use.name,
                   data->min_nm, data->max_nm, range_.min_nm, range_.max_nm,
                   extrapolates ? "the end values are continued" : "the value is 0"));
}

double SpectrumTableBuilder::guide_mean(const Spectrum& spectrum) const {
  double sum = 0;
  for (const Channel& band : scene_.guide) sum += spectrum.mean(band.min_nm, band.max_nm);
  return sum / static_cast<double>(scene_.guide.size());
}

double SpectrumTableBuilder::bound(const Spectrum& spectrum) const {
  double largest = 0;
  for (const Channel& band : scene_.guide)
    largest = std::max(largest, spectrum.max_over(band.min_nm, band.max_nm));
  for (const Channel& band : scene_.channels)
    largest = std::max(largest, spectrum.max_over(band.min_nm, band.max_nm));
  return largest;
}

}  // namespace kiloband
