// Cubes with known contents.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/cube_files.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

/// Numbers of every magnitude, with a few special ones, from a fixed generator (SplitMix64).
inline std::vector<float> test_numbers(std::size_t count, uint64_t seed) {
  std::vector<float> numbers(count);
  for (float& number : numbers) {
    uint64_t z = (seed += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    z ^= z >> 31;
    // exponents 2^-60 .. 2^60, so that neither densities nor squares leave the range of a float
    number = std::bit_cast<float>(static_cast<uint32_t>((67 + z % 121) << 23 | (z >> 41)));
  }
  return numbers;
}

inline Cube make_cube(uint32_t width, uint32_t height, std::vector<Band> bands, bool variance = false,
                      std::vector<std::string> aux = {}) {
  Cube cube;
  cube.info.width = width;
  cube.info.height = height;
  cube.info.bands = std::move(bands);
  cube.info.variance = variance;
  cube.info.aux = std::move(aux);
  const std::size_t pixels = std::size_t{width} * height;
  cube.mean = test_numbers(pixels * cube.info.bands.size(), 1);
  if (variance) cube.variance = test_numbers(cube.mean.size(), 2);
  cube.aux = test_numbers(pixels * cube.info.aux.size(), 3);
  return cube;
}

/// Equal channels between two edges.
inline std::vector<Band> equal_bands(double first_nm, double last_nm, std::size_t count) {
  std::vector<Band> bands;
  const double step = (last_nm - first_nm) / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k)
    bands.push_back(
        {{first_nm + static_cast<double>(k) * step, first_nm + static_cast<double>(k + 1) * step, ""},
         false});
  return bands;
}

inline CubeRows rows_of(const Cube& cube, uint32_t y0, uint32_t rows) {
  const auto part = [&](const std::vector<float>& all, std::size_t planes) {
    if (all.empty()) return std::span<const float>();
    const std::size_t row = std::size_t{cube.info.width} * planes;
    return std::span<const float>(all).subspan(y0 * row, rows * row);
  };
  const std::size_t bands = cube.info.bands.size();
  return {y0, rows, part(cube.mean, bands), part(cube.variance, bands), part(cube.aux, cube.info.aux.size())};
}

inline void write_rows_of(CubeWriter& writer, const Cube& cube, uint32_t strip) {
  for (uint32_t y = 0; y < cube.info.height; y += strip)
    writer.write_rows(rows_of(cube, y, std::min(strip, cube.info.height - y)));
}

inline void write_cube_file(const Cube& cube, const std::filesystem::path& file, uint32_t strip = 32) {
  if (cube.info.height < strip) strip = cube.info.height;
  const auto writer = create_cube_writer(file, cube.info, strip);
  write_rows_of(*writer, cube, strip);
  writer->finish();
}

/// Positions at which two buffers differ in their bits; SIZE_MAX if they are not of the same length.
inline std::size_t count_differences(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return SIZE_MAX;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    count += std::bit_cast<uint32_t>(a[i]) != std::bit_cast<uint32_t>(b[i]);
  return count;
}

}  // namespace kiloband::test
