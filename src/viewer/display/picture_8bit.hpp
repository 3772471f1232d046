// Planes as 8-bit pictures: exposure and tone curve, or a colour map.
#pragma once

#include <cstdint>
#include <vector>

#include "viewer/display/colour_map.hpp"
#include "viewer/display/plane.hpp"

namespace kiloband::viewer {

struct Picture8 {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgb;  // [y][x][3]
};

enum class Tone {
  kSrgb,  // linear to white, then clipped
  kFilmic  // a shoulder that keeps what is brighter than white: K. Narkowicz's fit of the curve of ACES (2015, CC0)
};

/// Pixels without a sample are this grey, which no exposure makes.
inline constexpr Colour kNoSample{64, 64, 72};

/// Exposure in stops at which the 99th percentile of the largest component is 0.9; 0 for black images.
double automatic_stops(const Plane& rgb);

/// rgb: 3 components, linear sRGB; stops: added to none, so 0 leaves values as they are
Picture8 tone_map(const Plane& rgb, double stops, Tone tone);

enum class MapScale { kLinear, kLogarithmic };

/// What the ends of a colour map stand for.
struct MapRange {
  float low = 0, high = 1;
};

/// 1st and 99th percentile, widened to an interval; logarithmic: of what is above 0, at most 8 decades.
MapRange automatic_range(const Plane& plane, MapScale scale);

/// Values beyond the range get the colours of its ends.
Picture8 map_colours(const Plane& plane, MapName map, MapScale scale, const MapRange& range);

}  // namespace kiloband::viewer
