// Small spectral images for tests, written by the program's own writers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "cube/cube_io.hpp"

namespace kiloband::test {

/// Mean density of a band at a pixel.
using BandValue = std::function<double(uint32_t x, uint32_t y, std::size_t band)>;

/// Writes an EXR or ENVI file by the name's extension. quantity: of the values in the file
void write_cube(const std::filesystem::path& file, uint32_t width, uint32_t height, const ChannelList& bands,
                const BandValue& value, Quantity quantity = Quantity::kDensity);

}  // namespace kiloband::test
