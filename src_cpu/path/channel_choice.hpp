// Which channel goes on behind a refraction that depends on wavelength.
//
// A channel is worth following as far as it still carries light: its probability is
//   p_k = (1 - e) t_b(k) / sum_m t_b(m) + e / K,   e = KB_EVEN_CHANNELS,
// where t_b is the product of the reflectances on the path so far, followed as means over bins of channels
// (SceneFeatures without dispersion have none). It goes on with weight 1 / p_k, so any t gives the right
// mean; for white paths p_k = 1 / K.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "shared/records.h"
#include "shared/spectra_layout.h"

namespace kiloband::cpu {

using BinnedThroughput = std::array<float, KB_CHANNEL_BINS>;

struct ChannelChoice {
  uint32_t channel = 0;
  float probability = 1;
};

/// bins: FlatScene::channel_bins. Multiplies by what the vertex' scattering does to the channels, up to a
/// factor common to all; textures and Fresnel's reflectances count as 1.
void carry(BinnedThroughput& carried, const KbPathVertex& vertex, std::span<const float> bins);

/// u uniform in [0, 1).
ChannelChoice choose_channel(const BinnedThroughput& carried, uint32_t channels, float u);

}  // namespace kiloband::cpu
