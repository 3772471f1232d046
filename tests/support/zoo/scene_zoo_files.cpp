// The files that the zoo's scenes name.
#include "scene/read/reader.hpp"
#include "tests/support/cube_files.hpp"
#include "tests/support/picture_files.hpp"
#include "tests/support/zoo/scene_zoo.hpp"

namespace kiloband::test {
namespace {

/// Colours from 40 to 230 without a pattern that a shifted or mirrored lookup could miss.
std::string colours(int width, int height, int values) {
  std::string bytes;
  uint32_t state = 12345;
  for (int i = 0; i < width * height * values; ++i) {
    state = state * 1664525u + 1013904223u;
    bytes.push_back(static_cast<char>(40 + (state >> 24) % 191));
  }
  return bytes;
}

/// An 8-bit picture, binary PPM (3 values per pixel) or PGM (1).
std::string picture(int width, int height, int values) {
  return std::string(values == 3 ? "P6" : "P5") + "\n" + std::to_string(width) + " " +
         std::to_string(height) + "\n255\n" + colours(width, height, values);
}

/// A sky with a small sun, 16 x 8.
std::string sky() {
  std::vector<float> texels;
  for (int y = 7; y >= 0; --y) {
    for (int x = 0; x < 16; ++x) {
      const bool sun = y == 6 && x == 5;
      texels.insert(texels.end(), {sun ? 30.0f : 0.2f + 0.02f * static_cast<float>(x), sun ? 28.0f : 0.3f,
                                   sun ? 20.0f : 0.25f + 0.05f * static_cast<float>(y)});
    }
  }
  return pfm_image(16, 8, 3, texels);
}

/// An octahedron: without normals in the file it is smoothed.
const char* const kGem =
    "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
    "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
/// An equilateral prism, edges along y.
const char* const kPrism =
    "v -0.5 -1 0\nv 0.5 -1 0\nv 0 -1 0.866\nv -0.5 1 0\nv 0.5 1 0\nv 0 1 0.866\n"
    "f 1 2 3\nf 6 5 4\nf 1 4 5 2\nf 2 5 6 3\nf 3 6 4 1\n";

/// Reflectances in regular bands, a lamp in irregular ones, a sky whose sun is bright
/// in the short bands only.
void write_spectral_images(const std::filesystem::path& folder) {
  ChannelList regular, irregular, sky;
  for (int i = 0; i < 22; ++i) regular.push_back({440.0 + 10 * i, 450.0 + 10 * i, ""});
  for (double nm = 440; nm < 660; nm += regular.size() % 2 == irregular.size() % 2 ? 10 : 20)
    irregular.push_back({nm, nm + 10, ""});
  for (int i = 0; i < 6; ++i) sky.push_back({430.0 + 40 * i, 470.0 + 40 * i, ""});
  write_cube(folder / "bands.exr", 6, 4, regular, [](uint32_t x, uint32_t y, std::size_t b) {
    return 0.1 + 0.8 * static_cast<double>((7 * x + 11 * y + 5 * b) % 23) / 22;
  });
  write_cube(folder / "glow.hdr", 3, 3, irregular, [](uint32_t x, uint32_t y, std::size_t b) {
    return 1.0 + static_cast<double>((5 * x + 3 * y + 2 * b) % 9);
  });
  write_cube(folder / "bright.exr", 16, 9, sky, [](uint32_t x, uint32_t y, std::size_t b) {
    const bool sun = x == 5 && y == 2 && b < 3;
    return sun ? 40.0 : 0.2 + 0.02 * x + 0.05 * y + 0.1 * static_cast<double>(b);
  });
}

/// A folded square with a temperature at each vertex.
const char* const kHotPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float u\nproperty float v\nproperty float kelvin\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n"
    "-1 -1 0 0 0 2000\n1 -1 0.2 1 0 2200\n1 1 0 1 1 2500\n-1 1 0.2 0 1 2300\n3 0 1 2\n3 0 2 3\n";

/// A crooked strip of four triangles with colours and values at vertices and faces.
const char* const kTintedPly =
    "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
    "property float r\nproperty float g\nproperty float b\nproperty float w\nelement face 4\n"
    "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    "-1 -1 0 0.9 0.1 0.2 0.1\n1 -1 0.2 0.2 0.8 0.1 0.9\n-1 0 0.3 0.1 0.3 0.9 0.5\n1 0 0 0.6 0.6 0.6 0.7\n"
    "-1 1 0 0.8 0.7 0.1 0.2\n1 1 0.1 0.3 0.9 0.8 0.4\n"
    "3 0 1 2 200 40 40\n3 1 3 2 40 200 60\n3 2 3 4 80 60 220\n3 3 5 4 128 128 128\n";

/// The same strip, as a strip.
const char* const kStripPly =
    "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
    "property list int int vertex_indices\nend_header\n-1 -1 0\n1 -1 0.2\n-1 0 0.3\n1 0 0\n-1 1 0\n1 1 0.1\n6 0 1 2 3 4 5\n";

/// Nodes of a plume, 4 x 3 x 5: temperature and scale.
std::string plume_nodes() {
  std::string text;
  for (int i = 0; i < 60; ++i)
    text += std::to_string(900 + i * 397 % 1300) + " " + std::to_string(i * 7 % 11) + "\n";
  return text;
}

}  // namespace

ZooFolder::ZooFolder() {
  write("colours.ppm", picture(7, 5, 3));
  write("grey.pgm", picture(6, 6, 1));
  write("sky.pfm", sky());
  write_spectral_images(path());
  write("kelvin.pfm", pfm_image(3, 2, 1, {2300, 0, 2500, 2100, 2400, 2000}));
  write("tilts.pfm", pfm_image(3, 2, 3,
                               {0.8f, 0.5f, 0.9f, 0.4f, 0.7f, 0.95f, 0.5f, 0.2f, 0.9f,  //
                                0.3f, 0.3f, 0.9f, 0.5f, 0.5f, 1, 0.65f, 0.75f, 0.9f}));
  write("above_one.pfm", pfm_image(2, 2, 1, {1, 1.3f, 1.7f, 2.5f}));
  write("hot.ply", kHotPly);
  write("tinted.ply", kTintedPly);
  write("strip.ply", kStripPly);
  write("gem.obj", kGem);
  write("prism.obj", kPrism);
  write("plume.txt", plume_nodes());
  write("glass.txt", "380 1.60\n500 1.545\n600 1.525\n720 1.51\n");
}

FlatScene ZooFolder::flatten(const ZooScene& scene, const std::string& bands) const {
  SceneDescription description = read_scene_text(scene.xml, scene.name + ".xml", path(), {});
  Film& film = description.sensor.film;
  if (film.width == 1)
    film.width = film.height = film.crop_width = film.crop_height = 32;  // a meter: more of its rays
  return *compile_scene(description, {parse_channels(bands), parse_channels(kZooBands), {}});
}

DerivedChannels zoo_responses(const ChannelList& channels) {
  const Channel range = hull(channels);
  DerivedChannels derived;
  derived.names = {"triangle", "all"};
  derived.responses = {
      resample(Spectrum::tabulated({450, 540, 650}, {0, 1, 0.1}), range.min_nm, range.max_nm),
      resample(Spectrum::constant(1), range.min_nm, range.max_nm)};
  return derived;
}

}  // namespace kiloband::test
