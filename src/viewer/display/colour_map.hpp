// Perceptually uniform colour maps, which people who confuse red and green can read.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace kiloband::viewer {

enum class MapName { kViridis, kCividis, kMagma, kGrey };

/// "viridis", "cividis", "magma", "grey"; nothing for others.
std::optional<MapName> find_colour_map(std::string_view name);

using Colour = std::array<uint8_t, 3>;
using ColourMap = std::array<Colour, 256>;

/// From the lowest value to the highest.
const ColourMap& colour_map(MapName name);

/// "#440154"
std::string to_hex(const Colour& colour);

}  // namespace kiloband::viewer
