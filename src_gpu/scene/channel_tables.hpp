// Spectra for devices: every row tabulated over mu per channel (KbChannelTable), in the numbering of
// KbSpectraLayout. All values are computed in double and rounded once.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"
#include "shared/pipeline.h"
#include "shared/spectra_layout.h"

namespace kiloband::opencl {

struct ChannelTableOptions {
  double relative_error = 1e-6;                  // of the row's largest value in the channel
  uint32_t max_cells = 4096;                     // per row
  std::size_t max_bytes = std::size_t{1} << 28;  // of all nodes; beyond, rows get fewer cells
  std::size_t max_line_bytes = std::size_t{1}
                               << 31;  // of the points of rows that keep them; beyond: InputError
};

/// What the kernels of spectra and evaluation read (see the table of kernels in kernels/evaluate/evaluate.cl).
///
/// Between nodes rows are linear in mu. Tabulated spectra are piecewise linear: where nodes meet their kinks,
/// as with equal channels on a table's grid, interpolation is exact. A jump (an end of data inside a channel)
/// is a ramp over one cell. Absorption coefficients of gases keep the very knots
/// of their data instead (cells = 0), and so do spectra and responses that are too narrow for the cells.
struct ChannelTables {
  KbSpectraLayout layout{};
  std::vector<KbChannelTable> tables;   // by row
  std::vector<float> nodes;             // nodes[first + j * stride + k]; `first` is a multiple of 16
  std::vector<uint32_t> material_rows;  // by material: conductor: row of n - 1, k follows; dispersive: row of
                                        // interior/exterior - 1; else (perfect mirrors too) KB_NONE
  std::vector<KbCover> cover;           // K + 1
  std::vector<KbCoverBreak> cover_breaks;  // see KbCover
  std::vector<double> derived_scale;       // by derived channel: film unit, W m^-2 sr^-1
  std::vector<double> error;   // by row: largest interpolation error beside jumps, relative to the
                               // row's largest value in the channel
  std::vector<bool> has_jump;  // by row: data end inside a channel, and a ramp stands for it
  bool has_lines = false;      // rows besides those of gases keep their knots
};

/// throws InputError        channels overlap so much that counting covers takes more memory than allowed
///        std::logic_error  channel_scale has not K entries, a material refers to no row
ChannelTables make_channel_tables(const FlatScene& scene, const DerivedChannels& derived,
                                  const ChannelTableOptions& options = {});

}  // namespace kiloband::opencl
