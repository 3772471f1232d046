// Cubes in memory and in files, by the program's own readers and writers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "cube/cube_io.hpp"

namespace kiloband::test {

/// A cube in memory, [y][x][band], values as the reader gives them.
struct Cube {
  CubeInfo info;
  std::vector<float> mean, variance, aux;

  std::size_t pixels() const { return std::size_t{info.width} * info.height; }
};

/// Reads a whole cube in strips of `strip` rows.
inline Cube read_cube(CubeReader& reader, uint32_t strip = 7) {
  Cube cube;
  cube.info = reader.info();
  const std::size_t bands = cube.info.bands.size();
  for (uint32_t y = 0; y < cube.info.height; y += strip) {
    const uint32_t rows = std::min(strip, cube.info.height - y);
    const std::size_t pixels = std::size_t{rows} * cube.info.width;
    std::vector<float> mean(pixels * bands), variance(cube.info.variance ? mean.size() : 0),
        aux(pixels * cube.info.aux.size());
    reader.read_rows(y, rows, mean, variance);
    reader.read_aux(y, rows, aux);
    cube.mean.insert(cube.mean.end(), mean.begin(), mean.end());
    cube.variance.insert(cube.variance.end(), variance.begin(), variance.end());
    cube.aux.insert(cube.aux.end(), aux.begin(), aux.end());
  }
  return cube;
}

inline Cube read_cube(const std::filesystem::path& file, uint32_t strip = 7) {
  return read_cube(*open_cube(file), strip);
}

/// Mean density of a band at a pixel.
using BandValue = std::function<double(uint32_t x, uint32_t y, std::size_t band)>;

/// Writes an EXR or ENVI file by the name's extension. quantity: of the values in the file
inline void write_cube(const std::filesystem::path& file, uint32_t width, uint32_t height,
                       const ChannelList& bands, const BandValue& value,
                       Quantity quantity = Quantity::kDensity) {
  CubeInfo info;
  info.width = width;
  info.height = height;
  info.quantity = quantity;
  for (const Channel& band : bands) info.bands.push_back({band, false});
  std::vector<float> integrals;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (std::size_t b = 0; b < bands.size(); ++b)
        integrals.push_back(static_cast<float>(value(x, y, b) * bands[b].width_nm()));
  const auto writer = create_cube_writer(file, info, height);
  writer->write_rows({0, height, integrals, {}, {}});
  writer->finish();
}

}  // namespace kiloband::test
