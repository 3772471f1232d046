// Images whose pixels are spectra, or weights of spectra: what spectral textures
// and environments are made of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "base/diagnostics.hpp"
#include "spectral/channels.hpp"

namespace kiloband {

/// Row 0 = top. All values are finite and >= 0.
struct SpectralImage {
  std::filesystem::path file;
  uint32_t width = 0, height = 0;
  uint32_t values_per_pixel = 0;  // M bands, or P weights
  ChannelList bands;              // M of them by ascending centre; empty: the values are weights
  std::shared_ptr<const std::vector<float>> values;  // [y][x][value]
};

/// Reads a spectral EXR or ENVI file. Values are the means of bands, W m^-2 sr^-1 nm^-1 or reflectances:
/// files that hold integrals are divided by the bands' widths. Bands without wavelengths (sensor responses)
/// are left out, with a note. Slightly negative values (negative_values.hpp, of each band by its own mean)
/// become 0, with one warning.
/// throws InputError   naming the file: what open_cube() refuses, no band with wavelengths, equal centres,
///                     more than 65535 pixels in a dimension; a value that is not finite or clearly negative,
///                     with pixel and band
///        DeviceError  not enough memory
SpectralImage read_spectral_image(const std::filesystem::path& file, const DiagnosticSink& sink);

/// Reads weights: the bands of an ENVI file (.hdr, .img) in the file's order, with or without wavelengths; of
/// any other image the one or three channels of read_image(), not decoded (8-bit values / 255).
/// throws as read_spectral_image() and read_image()
SpectralImage read_weight_image(const std::filesystem::path& file, const DiagnosticSink& sink);

}  // namespace kiloband
