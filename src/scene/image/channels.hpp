// Which channels of a file are the picture, and how their numbers become linear light.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace kiloband {

/// Places of the chosen channels in the file: one or three.
struct ImageChannels {
  std::array<int, 3> index{};
  int count = 0;  // 0: no rule of image.hpp applies
};

/// Chooses by the rules in image.hpp.
/// alpha  place of the alpha channel, -1 if there is none
ImageChannels choose_channels(const std::vector<std::string>& names, int alpha);

/// Whether a file has bands of the spectral EXR layout (docs/output_formats.md): "S0.550,0nm", "T.0,55um".
bool has_spectra(const std::vector<std::string>& names);

}  // namespace kiloband
