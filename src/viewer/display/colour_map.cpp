#include "viewer/display/colour_map.hpp"

#include <fmt/format.h>

#include "viewer/display/colour_map_tables.h"

namespace kiloband::viewer {
namespace {

constexpr uint8_t digit(char c) {
  return static_cast<uint8_t>(c <= '9' ? c - '0' : c - 'a' + 10);
}

constexpr ColourMap parse_map(std::string_view hex) {
  ColourMap map{};
  for (std::size_t i = 0; i < map.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      map[i][c] = static_cast<uint8_t>(16 * digit(hex[6 * i + 2 * c]) + digit(hex[6 * i + 2 * c + 1]));
  }
  return map;
}

constexpr ColourMap grey_map() {
  ColourMap map{};
  for (std::size_t i = 0; i < map.size(); ++i) map[i].fill(static_cast<uint8_t>(i));
  return map;
}

constexpr std::size_t kDigits = 6 * 256;
static_assert(kViridis.size() == kDigits && kMagma.size() == kDigits && kCividis.size() == kDigits);

}  // namespace

std::optional<MapName> find_colour_map(std::string_view name) {
  if (name == "viridis") return MapName::kViridis;
  if (name == "cividis") return MapName::kCividis;
  if (name == "magma") return MapName::kMagma;
  if (name == "grey") return MapName::kGrey;
  return std::nullopt;
}

const ColourMap& colour_map(MapName name) {
  static constexpr ColourMap kMaps[] = {parse_map(kViridis), parse_map(kCividis), parse_map(kMagma),
                                        grey_map()};
  return kMaps[static_cast<std::size_t>(name)];
}

std::string to_hex(const Colour& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

}  // namespace kiloband::viewer
