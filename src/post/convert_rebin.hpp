// Which fine bands make up a coarse channel.
#pragma once

#include <string>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband {

/// How far edges of bands at a wavelength may differ and be the same, nm: they were computed along different ways.
double edge_tolerance(double nm);

/// Indices of bands that tile `coarse` exactly, without gap or overlap (to the
/// edge_tolerance()). A single band is preferred to several.
/// what  names the channel in messages
/// throws InputError  there are none; says what is in the way
std::vector<std::size_t> bands_of_channel(const std::vector<Band>& bands, const Channel& coarse,
                                          const std::string& what);

}  // namespace kiloband
