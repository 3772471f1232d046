// Spectra of pixels and rectangles.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "viewer/display/plane.hpp"

namespace kiloband::viewer {

/// Pixels x0 .. x1, y0 .. y1 of the full image, inclusive.
struct Selection {
  std::string text;  // as it was asked for
  uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Where a coordinate of the full image, of `full` pixels, lies in one of `size` that may be reduced.
uint32_t reduced(uint32_t at, uint32_t full, uint32_t size);

inline constexpr std::size_t kMostSelections = 16;

/// "120,88;10,10,40,32": points and rectangles.
/// throws InputError  text that is none, more than kMostSelections, pixels beyond width x height
std::vector<Selection> parse_selections(std::string_view text, uint32_t width, uint32_t height);

/// Densities (W m^-2 sr^-1 nm^-1; derived bands as they are), per band.
struct Curve {
  uint64_t pixels = 0;      // with a value
  std::vector<float> mean;  // of the pixels that have one in this band; NaN without
  /// NaN where variances are not known, and of several pixels unless their errors are independent: where they share
  /// wavelengths, the error of their mean may be anything up to that of one.
  std::vector<float> standard_error;
};

/// full_width, full_height: what selections count in; an image that is reduced gives the pixel that covers them
/// threads: among how many rows are dealt, at least 1
std::vector<Curve> read_curves(const PixelSource& pixels, std::vector<Selection> selections,
                               uint32_t full_width, uint32_t full_height, unsigned threads);

}  // namespace kiloband::viewer
