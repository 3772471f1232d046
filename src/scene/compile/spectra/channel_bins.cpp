#include "scene/compile/spectra/channel_bins.hpp"

#include <algorithm>

#include "shared/spectra_layout.h"

namespace kiloband {
namespace {

/// Mean of the table over the channels' centres; 0 where the bin has no channel.
float bin_mean(const RegularTable& table, const ChannelList& channels, uint32_t bin) {
  const auto count = static_cast<uint32_t>(channels.size());
  const uint32_t begin = kb_channel_bin_begin(bin, count), end = kb_channel_bin_begin(bin + 1, count);
  double sum = 0;
  for (uint32_t k = begin; k < end; ++k) sum += table(channels[k].centre_nm());
  return end > begin ? static_cast<float>(sum / (end - begin)) : 0.0f;
}

}  // namespace

void set_channel_bins(FlatScene& scene) {
  if (!scene.features.dispersion) return;
  scene.channel_bins.assign(scene.spectra.size() * KB_CHANNEL_BINS, 1.0f);
  for (std::size_t row = 0; row < scene.spectra.size(); ++row) {
    const SpectrumRow& spectrum = scene.spectra[row];
    if (spectrum.is_planck || spectrum.is_emission || spectrum.absorption) continue;
    for (uint32_t bin = 0; bin < KB_CHANNEL_BINS; ++bin)
      scene.channel_bins[row * KB_CHANNEL_BINS + bin] = bin_mean(spectrum.table, scene.channels, bin);
  }
}

}  // namespace kiloband
