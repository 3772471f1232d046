#include "scene/compile/spectra/channel_scales.hpp"

#include <algorithm>
#include <cmath>

#include "spectral/planck.hpp"

namespace kiloband {
namespace {

/// Largest value of an emission row in a channel, W m^-2 sr^-1 nm^-1: at all knots of its table, and at five
/// wavelengths (Planck's law is smooth; emissivities count as 1).
double peak_in(const SpectrumRow& row, const Channel& channel) {
  double peak = 0;
  for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double lambda = (1 - t) * channel.min_nm + t * channel.max_nm;
    const bool inside = lambda >= row.planck_min_nm && lambda <= row.planck_max_nm;
    const double value = row.is_planck
                             ? (inside ? row.planck_scale * planck_radiance(lambda, row.temperature_k) : 0)
                             : row.table(lambda);
    peak = std::max(peak, value);
  }
  if (row.is_planck || row.table.values.empty()) return peak;
  const auto last = static_cast<double>(row.table.values.size() - 1);
  const double from = std::clamp((channel.min_nm - row.table.min_nm) / row.table.step_nm, 0.0, last);
  const double to = std::clamp((channel.max_nm - row.table.min_nm) / row.table.step_nm, 0.0, last);
  for (auto i = static_cast<std::size_t>(std::ceil(from)); i <= static_cast<std::size_t>(to); ++i) {
    peak = std::max(peak, row.table.values[i]);
  }
  return peak;
}

}  // namespace

/// The power of two below the largest channel value that an emission row or bitmap reaches: path sums are
/// then of order 1 however dim the channel is (Planck's law at 0.3 um and 200 K is 1e-96).
void set_channel_scales(FlatScene& scene, const EmissionPeaks& peaks, std::span<const Heat> heats) {
  scene.channel_scale.assign(scene.channels.size(), 1.0);
  for (std::size_t k = 0; k < scene.channels.size(); ++k) {
    const Channel& channel = scene.channels[k];
    double peak = peaks.raw;
    for (std::size_t row = 0; row < scene.spectra.size(); ++row) {
      if (!scene.spectra[row].is_emission) continue;
      const double scale = row == peaks.rgb_row ? std::max(1.0, peaks.rgb) : 1.0;
      const auto weight = peaks.row_factors.find(static_cast<uint32_t>(row));
      const double largest = weight == peaks.row_factors.end() ? scale
                             : row == peaks.rgb_row            ? std::max(scale, weight->second)
                                                               : weight->second;
      peak = std::max(peak, largest * peak_in(scene.spectra[row], channel));
    }
    for (const Spectrum& spectrum : peaks.spectra)
      peak = std::max(peak, spectrum.max_over(channel.min_nm, channel.max_nm));
    for (const Heat& heat : heats) {
      if (heat.field == KB_NONE) continue;
      for (const double nm : {channel.min_nm, channel.centre_nm(), channel.max_nm})
        peak = std::max(peak, planck_radiance(nm, heat.temperature_k));
    }
    if (peak > 0) scene.channel_scale[k] = std::exp2(std::floor(std::log2(peak * channel.width_nm())));
  }
}

}  // namespace kiloband
