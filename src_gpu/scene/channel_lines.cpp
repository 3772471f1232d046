#include "src_gpu/scene/channel_lines.hpp"

#include "shared/lang.h"

namespace kiloband::opencl {
namespace {

std::size_t padded_floats(std::size_t n) {
  return (n + 15) / 16 * 16;
}

/// Floats before the knots of a gas's row: where each channel's begin.
std::size_t line_heads(const ChannelKnots& lines) {
  return padded_floats(lines.first.size());
}

}  // namespace

std::size_t line_floats(const ChannelKnots& lines) {
  return line_heads(lines) + padded_floats(2 * lines.mu.size());
}

void fill_lines(const ChannelKnots& lines, float* nodes) {
  const std::size_t heads = line_heads(lines);
  for (std::size_t k = 0; k < lines.first.size(); ++k)
    nodes[k] = kb_as_f32(static_cast<uint32_t>(heads + 2 * std::size_t{lines.first[k]}));
  for (std::size_t i = 0; i < lines.mu.size(); ++i) {
    nodes[heads + 2 * i] = static_cast<float>(lines.mu[i]);
    nodes[heads + 2 * i + 1] = static_cast<float>(lines.value[i]);
  }
}

}  // namespace kiloband::opencl
