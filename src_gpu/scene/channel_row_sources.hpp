// What rows of channel tables are made of: functions of wavelength with their kinks and jumps.
#pragma once

#include "scene/compile/flat_scene.hpp"
#include "src_gpu/scene/channel_row.hpp"

namespace kiloband::opencl {

/// A spectrum of the scene: a table, or Planck's law times a table. `row` must outlive the function.
RowFunction spectrum_row(const SpectrumRow& row);
/// Where textures are evaluated: clamp(lambda, 360, 830) - KB_TEXTURE_CENTRE_NM, nm.
RowFunction wavelength_row();
/// Position in bands: linear between centres, constant outside. `set` must outlive the function.
RowFunction band_position_row(const BandSet& set);

}  // namespace kiloband::opencl
