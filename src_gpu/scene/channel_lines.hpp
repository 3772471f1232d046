// Rows of gases in channel tables: the knots of absorption lines, channel by channel.
#pragma once

#include <cstddef>

#include "spectral/channel_knots.hpp"

namespace kiloband::opencl {

/// Floats that the row takes, heads and knots.
std::size_t line_floats(const ChannelKnots& lines);

/// Writes the row: where each channel's knots begin, then pairs of mu and value; line_value() of
/// kernels/evaluate/spectral_row.clh reads it.
void fill_lines(const ChannelKnots& lines, float* nodes);

}  // namespace kiloband::opencl
