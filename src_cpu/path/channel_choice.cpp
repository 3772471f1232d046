#include "src_cpu/path/channel_choice.hpp"

#include <algorithm>
#include <cmath>

namespace kiloband::cpu {
namespace {

uint32_t bin_size(uint32_t bin, uint32_t channels) {
  return kb_channel_bin_begin(bin + 1, channels) - kb_channel_bin_begin(bin, channels);
}

float probability_in(float carried, float total, uint32_t channels) {
  const float even = 1 / static_cast<float>(channels);
  if (!(total > 0)) return even;
  return (1 - KB_EVEN_CHANNELS) * (carried / total) + KB_EVEN_CHANNELS * even;
}

/// B of KB_KIND_TINTED
float tinted(const KbPathVertex& vertex, float a) {
  const float w1 = vertex.scatter1;
  return vertex.scatter0 * a + (w1 >= 0 ? w1 : -w1 * std::sqrt(a));
}

}  // namespace

void carry(BinnedThroughput& carried, const KbPathVertex& vertex, std::span<const float> bins) {
  const uint32_t kind = vertex.head & KB_VERTEX_KIND_MASK;
  if (kind == KB_KIND_MEDIUM) return;  // gas: lines are finer than bins
  const bool two = kb_has_two_spectra(kind);
  if (vertex.head & (KB_VERTEX_TEX_A | (two ? KB_VERTEX_TEX_B : 0u))) return;
  const float* a = &bins[std::size_t{vertex.row_a} * KB_CHANNEL_BINS];
  const float* b = two ? &bins[std::size_t{vertex.row_b} * KB_CHANNEL_BINS] : a;
  const float sum = vertex.scatter0 + vertex.scatter1;
  const float share = two && sum > 0 ? vertex.scatter1 / sum : 0.0f;
  float largest = 0;
  for (uint32_t i = 0; i < KB_CHANNEL_BINS; ++i) {
    carried[i] *= kind == KB_KIND_TINTED ? tinted(vertex, a[i]) : (1 - share) * a[i] + share * b[i];
    largest = std::max(largest, carried[i]);
  }
  if (!(largest > 0)) return;  // nothing goes on: any choice is as good
  const float scale = 1 / largest;
  for (float& value : carried) value *= scale;
}

/// The part KB_EVEN_CHANNELS of u chooses evenly; the rest walks the bins.
ChannelChoice choose_channel(const BinnedThroughput& carried, uint32_t channels, float u) {
  float total = 0;
  for (uint32_t b = 0; b < KB_CHANNEL_BINS; ++b)
    total += carried[b] * static_cast<float>(bin_size(b, channels));
  ChannelChoice choice;
  if (u < KB_EVEN_CHANNELS || !(total > 0)) {
    const float v = total > 0 ? u / KB_EVEN_CHANNELS : u;
    choice.channel = std::min(static_cast<uint32_t>(v * static_cast<float>(channels)), channels - 1);
  } else {
    float rest = (u - KB_EVEN_CHANNELS) / (1 - KB_EVEN_CHANNELS) * total;
    for (uint32_t b = 0; b < KB_CHANNEL_BINS; ++b) {
      const uint32_t size = bin_size(b, channels);
      const float mass = carried[b] * static_cast<float>(size);
      if (!(mass > 0)) continue;
      const auto within = std::min(static_cast<uint32_t>(rest / carried[b]), size - 1);
      choice.channel = kb_channel_bin_begin(b, channels) + within;
      if (rest < mass) break;
      rest -= mass;
    }
  }
  const auto bin = static_cast<uint32_t>(uint64_t{choice.channel} * KB_CHANNEL_BINS / channels);
  choice.probability = probability_in(carried[bin], total, channels);
  return choice;
}

}  // namespace kiloband::cpu
