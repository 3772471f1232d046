// One row of channel tables: how many cells a function of wavelength needs, and its nodes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "spectral/channel_knots.hpp"
#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband::opencl {

/// Edges of channels and of data that agree to this fraction are the same wavelength.
inline constexpr double kSameWavelength = 1e-11;

/// A function of wavelength that is linear, or at least smooth, between its kinks.
struct RowFunction {
  std::function<double(double)> value;  // of lambda_nm
  std::vector<double> kinks_nm;         // ascending
  std::vector<double> jumps_nm;         // where the value jumps: ends of data
  bool curved = false;                  // not linear between kinks

  /// A table times `factor`.
  static RowFunction of_table(const RegularTable& table);
  /// Adds the kinks and jumps of another function that this one is made of.
  void merge(const RowFunction& other);
};

struct RowCells {
  uint32_t cells = 1;
  double error = 0;  // relative to the largest value in the channel, cells with a jump left out
  bool has_jump = false;
};

/// Cells of a row: the fewest with at most `wanted` error; where none of up to `most` attain that (kinks off
/// every grid), the fewest powers of two that attain `accepted`, else `most`. A row with a jump inside a
/// channel gets as many as fit `most`, so that the ramp in the jump's place is narrow.
RowCells choose_cells(const RowFunction& row, const ChannelList& channels, double wanted, double accepted,
                      uint32_t most);

/// The row at node j of a channel, as the limit from inside the channel.
double node_value(const RowFunction& row, const Channel& c, uint32_t j, uint32_t cells);

/// The error of a given number of cells.
double error_of_cells(const RowFunction& row, const ChannelList& channels, uint32_t cells);

/// What interpolation between a given number of cells makes of a channel's mean: the largest relative error, that of a row in one channel. Cells
/// without kinks and jumps are left out: there it is right, or as good as error_of_cells() says.
double mean_error_of_cells(const RowFunction& row, const ChannelList& channels, uint32_t cells);

/// What is made of a row's values: value * factor[k] - shift[k]; empty: 1 and 0.
struct RowUnits {
  std::vector<double> factor, shift;  // by channel
};

/// The row's very kinks and jumps in every channel, in the channel's units; curved rows in steps between them.
ChannelKnots knots_of(const RowFunction& row, const ChannelList& channels, const RowUnits& units);

/// nodes[j * stride + k] = row(lambda_k(mu = j / cells)) in the channel's units, j = 0 .. cells. At mu = 0
/// and 1 a jump counts as outside the channel.
void fill_nodes(const RowFunction& row, const ChannelList& channels, const RowUnits& units, uint32_t cells,
                std::size_t stride, float* nodes);

}  // namespace kiloband::opencl
