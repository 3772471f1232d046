// <texture type="spectral_bitmap">: an image of spectra, or an image of weights over named spectra.
#include <algorithm>
#include <cmath>
#include <set>

#include "scene/read/context.hpp"
#include "scene/xml/values.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

/// Weights are rounded: a mixture may be this much above 1.
constexpr double kMixtureRounding = 1e-6;

std::string endmember_name(std::size_t p) {
  return "endmember_" + std::to_string(p);
}

/// endmember_0 ... as quantities: numbers are flat, colours have no illuminant.
std::vector<Spectrum> read_endmembers(ReadContext& context, const ObjectReader& object,
                                      const SpectralImage& image) {
  std::vector<Spectrum> endmembers;
  while (object.has(endmember_name(endmembers.size()))) {
    const std::string name = endmember_name(endmembers.size());
    endmembers.push_back(read_spectrum(context, object, name, SpectrumUse::kQuantity, Spectrum()));
  }
  if (!object.is_whole()) endmembers.resize(image.values_per_pixel);
  if (endmembers.size() != image.values_per_pixel) {
    object.fail_at("weights", std::to_string(endmembers.size()) + " endmembers (endmember_0 ...) for " +
                                  std::to_string(image.values_per_pixel) + " weights of '" +
                                  image.file.filename().string() + "'");
  }
  return endmembers;
}

std::string place_in(const SpectralImage& image, std::size_t pixel) {
  return "pixel (" + std::to_string(pixel % image.width) + ", " + std::to_string(pixel / image.width) +
         ") of '" + image.file.filename().string() + "'";
}

void check_bands(const SpectralImage& image, const std::string& label, const Place& place) {
  const std::vector<float>& values = *image.values;
  const auto above = std::ranges::find_if(values, [](float v) { return v > 1; });
  if (above == values.end()) return;
  const auto i = static_cast<std::size_t>(above - values.begin());
  const Channel& band = image.bands[i % image.values_per_pixel];
  fail(place, label + " " + format_number(*above) + " at " + place_in(image, i / image.values_per_pixel) +
                  ", band " + format_number(band.min_nm) + "-" + format_number(band.max_nm) +
                  " nm: must be in [0, 1]");
}

/// Wavelengths at which mixtures are largest: all knots; curves of colours are looked at every 5 nm.
std::vector<double> wavelengths_of(const std::vector<Spectrum>& endmembers) {
  std::set<double> wavelengths{kCieMinNm};
  for (const Spectrum& spectrum : endmembers) {
    const auto knots = spectrum.knots_nm();
    wavelengths.insert(knots.begin(), knots.end());
    if (!knots.empty() || spectrum.is_constant()) continue;
    for (double nm = kCieMinNm; nm <= kCieMaxNm; nm += 5) wavelengths.insert(nm);
  }
  return {wavelengths.begin(), wavelengths.end()};
}

/// No mixture may be above 1. Most pixels pass by the sum of the endmembers' largest values.
void check_mixtures(const SpectralBitmapTexture& texture, const std::string& label, const Place& place) {
  const SpectralImage& image = *texture.image;
  const std::size_t count = texture.endmembers.size();
  const std::vector<double> wavelengths = wavelengths_of(texture.endmembers);
  std::vector<std::vector<double>> values;  // [endmember][wavelength]
  std::vector<double> largest;
  for (const Spectrum& spectrum : texture.endmembers) {
    values.emplace_back(wavelengths.size());
    spectrum.evaluate(wavelengths, values.back());
    largest.push_back(*std::ranges::max_element(values.back()));
  }
  const auto mixture = [&](const float* weights, const auto& value_of) {
    double sum = 0;
    for (std::size_t p = 0; p < count; ++p) sum += weights[p] * value_of(p);
    return sum;
  };
  for (std::size_t pixel = 0; pixel * count < image.values->size(); ++pixel) {
    const float* weights = image.values->data() + pixel * count;
    if (mixture(weights, [&](std::size_t p) { return largest[p]; }) <= 1 + kMixtureRounding) continue;
    for (std::size_t j = 0; j < wavelengths.size(); ++j) {
      const double sum = mixture(weights, [&](std::size_t p) { return values[p][j]; });
      if (sum <= 1 + kMixtureRounding) continue;
      fail(place, label + ": the weights at " + place_in(image, pixel) + " mix to " +
                      format_number(std::round(sum * 1e6) / 1e6) + " at " + format_number(wavelengths[j]) +
                      " nm: must be in [0, 1]");
    }
  }
}

}  // namespace

Texture read_spectral_bitmap(ReadContext& context, const ObjectReader& object) {
  auto texture = std::make_shared<SpectralBitmapTexture>();
  texture->id = object.node().id;
  texture->position = object.node().place.position();
  texture->nearest = object.get_choice("filter_type", {"bilinear", "nearest"}) == 1;
  constexpr WrapMode kModes[] = {WrapMode::kRepeat, WrapMode::kMirror, WrapMode::kClamp};
  texture->wrap = kModes[object.get_choice("wrap_mode", {"repeat", "mirror", "clamp"})];
  texture->to_uv = object.get_uv_transform("to_uv", context.sink);
  const bool weights = object.has("weights");
  if (weights && object.has("filename")) object.fail_at("weights", "'weights' together with 'filename'");
  const char* parameter = weights ? "weights" : "filename";
  const std::filesystem::path file = context.file(object, parameter);
  texture->image = context.spectral_image(file, weights, object.value_place(parameter));
  if (weights)
    texture->endmembers = read_endmembers(context, object, *texture->image);
  else
    texture->extrapolate = object.get_bool("extrapolate", false);
  object.finish();
  return std::shared_ptr<const SpectralBitmapTexture>(std::move(texture));
}

void check_spectral_reflectance(const SpectralBitmapTexture& texture, const std::string& label,
                                const Place& place) {
  if (texture.endmembers.empty()) return check_bands(*texture.image, label, place);
  for (std::size_t p = 0; p < texture.endmembers.size(); ++p) {
    if (texture.endmembers[p].planck_parameters())
      fail(place, label + ": " + endmember_name(p) + " describes emission: not allowed in a reflectance");
  }
  check_mixtures(texture, label, place);
}

}  // namespace kiloband
