// Upper bound of a metal's Fresnel reflectance over all channels: what roulette needs to end paths in metal
// cavities.
#pragma once

#include <vector>

#include "shared/material_tables.h"
#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Largest reflectance for light from vacuum over the channels of all lists (both ends and the middle of each,
/// with a slack for what lies between), at the KB_CONDUCTOR_CELLS + 1 cosines of material_tables.h.
/// n, k  over wavelength in nm
std::vector<float> make_conductor_bound(const RegularTable& n, const RegularTable& k,
                                        std::initializer_list<const ChannelList*> lists);

}  // namespace kiloband
