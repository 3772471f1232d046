#include <algorithm>

#include "scene/compile/flattener.hpp"
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

/// Where the channel that survives a dispersive refraction is chosen by what each can still carry, the
/// reflectances on the path so far are followed in a few bins of channels.
void Flattener::set_channel_bins() {
  if (!out_.features.dispersion) return;
  out_.channel_bins.assign(out_.spectra.size() * KB_CHANNEL_BINS, 1.0f);
  for (std::size_t row = 0; row < out_.spectra.size(); ++row) {
    const SpectrumRow& spectrum = out_.spectra[row];
    if (spectrum.is_planck || spectrum.is_emission || spectrum.absorption) continue;
    for (uint32_t bin = 0; bin < KB_CHANNEL_BINS; ++bin)
      out_.channel_bins[row * KB_CHANNEL_BINS + bin] = bin_mean(spectrum.table, out_.channels, bin);
  }
}

}  // namespace kiloband
