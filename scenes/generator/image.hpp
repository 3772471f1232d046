// Images that the generator computes: textures (8 bits, sRGB values) and environments (linear, float).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scenes/generator/vec.hpp"

namespace kiloband::generator {

/// Rows from the top.
struct Image {
  int width = 0, height = 0;
  std::vector<Vec3> pixels;

  Image() = default;
  Image(int w, int h, Vec3 colour = {})
      : width(w), height(h), pixels(static_cast<std::size_t>(w) * h, colour) {}
  Vec3& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  const Vec3& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// By file name: "wood.ppm" becomes textures/wood.ppm.
using Images = std::map<std::string, Image>;

/// .ppm: 8 bits, values in [0, 1]; .pfm: 32-bit floats.
/// throws std::runtime_error  cannot be written
void write_image(const Image& image, const std::filesystem::path& file);

}  // namespace kiloband::generator
