// Picture files that OpenImageIO does not write, by the libraries of their formats.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace kiloband::test {

struct PngSample {
  int width = 0, height = 0, colour_type = 0, bits = 8;
  bool interlaced = false, palette_alpha = false, transparent = false, gamma = false;
};

/// Random samples; with a palette of 16 colours, alpha of the first of them, a transparent colour, a gamma.
void write_png_sample(const std::filesystem::path& file, const PngSample& sample);

/// Random smooth colours. components: 1, 3, or 4 (CMYK).
void write_jpeg_sample(const std::filesystem::path& file, int components, bool progressive,
                       int restart_rows = 0);

/// Luminance and chroma at half the resolution, as OpenEXR's Rgba interface writes them.
void write_luminance_chroma_exr(const std::filesystem::path& file);

/// Two parts of which the first has HALF channels R, G, B and UINT "id".
void write_two_part_exr(const std::filesystem::path& file);

}  // namespace kiloband::test
