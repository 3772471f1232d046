// The only file of src/scene that reads cubes: spectral images are cubes, and there is one reader of them.
#include "scene/spectral_image.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string_view>

#include "base/text.hpp"
#include "film/cube_io.hpp"
#include "scene/image.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kMaxEdge = 65535;  // pixels: texel coordinates have 16 bits
constexpr uint32_t kRowsAtOnce = 32;  // the height of our own EXR tiles

/// Which of the file's bands are kept, in which order, and what their values are divided by.
struct BandChoice {
  std::vector<std::size_t> index;
  std::vector<double> divisor;
  std::vector<std::string> names;  // for messages
};

std::string name_of(const Band& band, std::size_t index) {
  const Channel& c = band.channel;
  if (!band.derived) return "band " + format_number(c.min_nm) + "-" + format_number(c.max_nm) + " nm";
  return "band " + std::to_string(index + 1);
}

BandChoice choose_bands(const CubeInfo& info, const std::string& where, const DiagnosticSink& sink) {
  BandChoice choice;
  for (std::size_t i = 0; i < info.bands.size(); ++i)
    if (!info.bands[i].derived) choice.index.push_back(i);
  if (choice.index.empty()) throw InputError(where + ": no band has wavelengths");
  if (choice.index.size() < info.bands.size()) {
    note(sink, {where},
         std::to_string(info.bands.size() - choice.index.size()) + " bands without wavelengths are left out");
  }
  const auto centre = [&](std::size_t i) { return info.bands[i].channel.centre_nm(); };
  std::ranges::stable_sort(choice.index, {}, centre);
  for (std::size_t n = 0; n < choice.index.size(); ++n) {
    const std::size_t i = choice.index[n];
    if (n > 0 && centre(i) == centre(choice.index[n - 1]))
      throw InputError(where + ": two bands have their centre at " + format_number(centre(i)) + " nm");
    choice.divisor.push_back(info.quantity == Quantity::kIntegral ? info.bands[i].channel.width_nm() : 1);
    choice.names.push_back(name_of(info.bands[i], i));
  }
  return choice;
}

BandChoice all_bands(const CubeInfo& info) {
  BandChoice choice;
  for (std::size_t i = 0; i < info.bands.size(); ++i) {
    choice.index.push_back(i);
    choice.divisor.push_back(1);
    choice.names.push_back("weight " + std::to_string(i));
  }
  return choice;
}

[[noreturn]] void refuse(const std::string& where, const std::string& name, float value, std::size_t pixel,
                         uint32_t width) {
  throw InputError(where + ": " + name + " at pixel (" + std::to_string(pixel % width) + ", " +
                   std::to_string(pixel / width) + "): " + format_number(value) +
                   ": must be finite and >= 0");
}

/// The chosen bands of all pixels; strip by strip, so that there is one copy of the image only.
std::vector<float> read_values(CubeReader& cube, const BandChoice& choice, const std::string& where) {
  const CubeInfo& info = cube.info();
  const std::size_t bands = info.bands.size(), kept = choice.index.size();
  std::vector<float> out(std::size_t{info.width} * info.height * kept);
  std::vector<float> strip;
  float* to = out.data();
  for (uint32_t y = 0; y < info.height; y += kRowsAtOnce) {
    const uint32_t rows = std::min(kRowsAtOnce, info.height - y);
    const std::size_t pixels = std::size_t{rows} * info.width;
    strip.resize(pixels * bands);
    cube.read_rows(y, rows, strip, {});
    for (std::size_t p = 0; p < pixels; ++p) {
      for (std::size_t n = 0; n < kept; ++n) {
        const float value = strip[p * bands + choice.index[n]];
        if (!(value >= 0) || std::isinf(value))
          refuse(where, choice.names[n], value, std::size_t{y} * info.width + p, info.width);
        *to++ = static_cast<float>(value / choice.divisor[n]);
      }
    }
  }
  return out;
}

SpectralImage read_cube(const std::filesystem::path& file, bool weights, const DiagnosticSink& sink) {
  const std::string where = file.string();
  const auto cube = open_cube(file, sink);
  const CubeInfo& info = cube->info();
  if (info.width > kMaxEdge || info.height > kMaxEdge) {
    throw InputError(where + ": image size " + std::to_string(info.width) + "x" +
                     std::to_string(info.height) + ": must be at most " + std::to_string(kMaxEdge) +
                     " in a dimension");
  }
  const BandChoice choice = weights ? all_bands(info) : choose_bands(info, where, sink);
  SpectralImage image;
  image.file = file;
  image.width = info.width;
  image.height = info.height;
  image.values_per_pixel = static_cast<uint32_t>(choice.index.size());
  if (!weights)
    for (const std::size_t i : choice.index) image.bands.push_back(info.bands[i].channel);
  try {
    image.values = std::make_shared<const std::vector<float>>(read_values(*cube, choice, where));
  } catch (const std::bad_alloc&) {
    throw DeviceError(where + ": not enough memory for the image");
  }
  return image;
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

/// Radiance HDR pictures have the extension of ENVI headers: the first bytes tell.
bool is_envi(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".img") return true;
  if (extension != ".hdr") return false;
  char first[4] = {};
  std::ifstream(file, std::ios::binary).read(first, sizeof first);
  return std::string_view(first, sizeof first) == "ENVI";
}

}  // namespace

SpectralImage read_spectral_image(const std::filesystem::path& file, const DiagnosticSink& sink) {
  return read_cube(file, false, sink);
}

SpectralImage read_weight_image(const std::filesystem::path& file, const DiagnosticSink& sink) {
  if (is_envi(file)) return read_cube(file, true, sink);
  Image picture = read_image(file, true);
  SpectralImage image;
  image.file = file;
  image.width = picture.width;
  image.height = picture.height;
  image.values_per_pixel = picture.channels;
  image.values = std::make_shared<const std::vector<float>>(std::move(picture.pixels));
  return image;
}

}  // namespace kiloband
