// Bands that have names only get wavelengths: the first step of select_from_cube().
#pragma once

#include <vector>

#include "post/convert.hpp"

namespace kiloband {

struct NamedBands {
  std::vector<Band> bands;         // in the cube's order
  std::vector<std::size_t> order;  // their indices: those that were named, in that order, then the others
};

/// throws InputError  no such band, a band that has wavelengths
NamedBands give_wavelengths(const std::vector<Band>& bands, const ChannelList& named);

}  // namespace kiloband
