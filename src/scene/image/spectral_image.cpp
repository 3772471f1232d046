// The only file of src/scene that reads cubes: spectral images are cubes, and there is one reader of them.
#include "scene/image/spectral_image.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <span>
#include <string_view>

#include "base/text.hpp"
#include "cube/cube_io.hpp"
#include "scene/image/image.hpp"
#include "scene/image/negative_values.hpp"

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
  if (choice.index.empty())
    throw InputError(where + ": no band has wavelengths: give them with kiloband convert --wavelengths");
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

/// Values of an image on their way in: those that are no light are refused, and bands remember what is
/// negative in them.
class ValueCheck {
 public:
  ValueCheck(const BandChoice& choice, uint32_t width, const std::string& where)
      : names_(choice.names), width_(width), where_(where), bands_(choice.names.size()) {}

  /// The n-th of the chosen values of a pixel; `value` as in the file, `kept` as it is used.
  void add(std::size_t n, std::size_t pixel, float value, float kept) {
    if (!std::isfinite(value)) refuse(n, value, pixel, "must be finite and >= 0");
    bands_[n].add(kept, pixel);
  }

  /// After the last value: sets the negative ones of `values` [pixel][n] to 0, with one warning.
  void settle(std::vector<float>& values, const DiagnosticSink& sink) const {
    std::size_t lowest = 0;
    for (std::size_t n = 0; n < bands_.size(); ++n) {
      if (!bands_[n].acceptable()) refuse(n, bands_[n].lowest(), bands_[n].lowest_index(), bands_[n].rule());
      if (bands_[n].lowest() < bands_[lowest].lowest()) lowest = n;
    }
    if (bands_[lowest].negative() == 0) return;
    uint64_t texels = 0;
    for (std::size_t first = 0; first < values.size(); first += bands_.size()) {
      const std::span<float> texel(&values[first], bands_.size());
      texels += std::ranges::any_of(texel, [](float v) { return v < 0; });
      for (float& value : texel) value = std::max(value, 0.0f);
    }
    const NegativeValues& band = bands_[lowest];
    warn(sink, {where_},
         std::to_string(texels) + (texels == 1 ? " texel has" : " texels have") +
             " slightly negative values, which are taken as 0; the lowest: " +
             describe(lowest, band.lowest(), band.lowest_index()));
  }

 private:
  std::string describe(std::size_t n, float value, std::size_t pixel) const {
    return names_[n] + " at pixel (" + std::to_string(pixel % width_) + ", " +
           std::to_string(pixel / width_) + "): " + format_number(value);
  }
  [[noreturn]] void refuse(std::size_t n, float value, std::size_t pixel, const std::string& rule) const {
    throw InputError(where_ + ": " + describe(n, value, pixel) + ": " + rule);
  }

  const std::vector<std::string>& names_;
  uint32_t width_;
  const std::string& where_;
  std::vector<NegativeValues> bands_;
};

/// The chosen bands of all pixels; strip by strip, so that there is one copy of the image only.
std::vector<float> read_values(CubeReader& cube, const BandChoice& choice, const std::string& where,
                               const DiagnosticSink& sink) {
  const CubeInfo& info = cube.info();
  const std::size_t bands = info.bands.size(), kept = choice.index.size();
  std::vector<float> out(std::size_t{info.width} * info.height * kept);
  std::vector<float> strip;
  ValueCheck check(choice, info.width, where);
  float* to = out.data();
  for (uint32_t y = 0; y < info.height; y += kRowsAtOnce) {
    const uint32_t rows = std::min(kRowsAtOnce, info.height - y);
    const std::size_t pixels = std::size_t{rows} * info.width;
    strip.resize(pixels * bands);
    cube.read_rows(y, rows, strip, {});
    for (std::size_t p = 0; p < pixels; ++p) {
      for (std::size_t n = 0; n < kept; ++n) {
        const float value = strip[p * bands + choice.index[n]];
        *to = static_cast<float>(value / choice.divisor[n]);
        check.add(n, std::size_t{y} * info.width + p, value, *to++);
      }
    }
  }
  check.settle(out, sink);
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
    image.values = std::make_shared<const std::vector<float>>(read_values(*cube, choice, where, sink));
  } catch (const std::bad_alloc&) {
    throw DeviceError(where + ": not enough memory for the image");
  }
  return image;
}

/// Radiance HDR pictures have the extension of ENVI headers: the first bytes tell.
bool is_envi(const std::filesystem::path& file) {
  const std::string extension = lowered_extension(file);
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
  Image picture = read_image(file, true, sink);
  SpectralImage image;
  image.file = file;
  image.width = picture.width;
  image.height = picture.height;
  image.values_per_pixel = picture.channels;
  image.values = std::make_shared<const std::vector<float>>(std::move(picture.pixels));
  return image;
}

}  // namespace kiloband
