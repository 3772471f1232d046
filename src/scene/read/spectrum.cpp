// Spectral parameters: <float>, <rgb>, <spectrum value= | filename=>.
#include <algorithm>
#include <cmath>

#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"
#include "spectral/colour/colour.hpp"
#include "spectral/colour/rgb.hpp"
#include "spectral/files/spectrum_files.hpp"

namespace kiloband {
namespace {

/// What the numbers in a file are.
ValueKind kind_of(SpectrumUse use) {
  switch (use) {
    case SpectrumUse::kReflectance:
    case SpectrumUse::kIndex:
      return ValueKind::kPlain;
    case SpectrumUse::kEmission:
      return ValueKind::kRadiance;
    case SpectrumUse::kIrradiance:
      return ValueKind::kIrradiance;
    case SpectrumUse::kIntensity:
      return ValueKind::kIntensity;
    case SpectrumUse::kAbsorption:
      return ValueKind::kAbsorption;
    default:
      return ValueKind::kAny;
  }
}

std::string_view rule(SpectrumUse use) {
  return use == SpectrumUse::kReflectance ? "must be in [0, 1]" : "must be >= 0";
}

bool is_allowed(double value, SpectrumUse use) {
  return value >= 0 && (use != SpectrumUse::kReflectance || value <= 1);
}

struct Limit {
  double most;
  std::string unit;
};

Limit limit_of(SpectrumUse use) {
  if (is_emission(use)) return {kMaxEmission, unit_of(kind_of(use))};
  if (use == SpectrumUse::kAbsorption) return {kMaxAbsorption, unit_of(kind_of(use))};
  return {kMaxQuantity, ""};
}

/// The largest value anywhere: of emission by formula, its peak.
void check_peak(const Spectrum& spectrum, const std::string& label, SpectrumUse use, const Place& place) {
  constexpr double kShortestNm = 1, kLongestNm = 1e9;
  const Limit limit = limit_of(use);
  const bool has_data = !spectrum.knots_nm().empty();
  const double peak = has_data ? *std::ranges::max_element(spectrum.knot_values())
                               : spectrum.max_over(kShortestNm, kLongestNm);
  if (peak <= limit.most) return;
  const auto at =
      has_data ? std::ranges::max_element(spectrum.knot_values()) - spectrum.knot_values().begin() : 0;
  const std::string where =
      has_data ? " at " + format_number(spectrum.knots_nm()[static_cast<std::size_t>(at)]) + " nm" : "";
  fail(place, label + " " + format_number(peak) + where + ": " + at_most(limit.most, limit.unit));
}

/// A number: flat, or times D65 on emitters.
Spectrum from_number(double value, SpectrumUse use) {
  return is_emission(use) ? illuminant_d65().scaled(value) : Spectrum::constant(value);
}

/// The same; what no such parameter can be is refused.
Spectrum checked_number(double value, const std::string& label, SpectrumUse use, const Place& place) {
  check_spectrum(Spectrum::constant(value), label, use, place);
  return from_number(value, use);
}

Rgb parse_rgb(const XmlAttribute& value, const std::string& context) {
  const std::vector<double> n = parse_numbers(value.value, value.value_place, context);
  if (n.size() == 1) return {n[0], n[0], n[0]};
  if (n.size() != 3)
    fail(value.value_place, context + "expected 1 or 3 numbers, found " + std::to_string(n.size()));
  return {n[0], n[1], n[2]};
}

/// A colour. Greys need no upsampling; quantities are scaled as emission is, without D65. The colours of a plugin `srgb` are reflectances, and
/// above 1 as much of the brightest one.
Spectrum from_rgb(const XmlAttribute& value, const std::string& label, SpectrumUse use) {
  const Rgb rgb = parse_rgb(value, label + ": ");
  for (const double component : rgb) {
    if (!is_allowed(component, use)) {
      fail(value.value_place,
           label + " rgb component " + format_number(component) + ": " + std::string(rule(use)));
    }
    const Limit limit = limit_of(use);
    if (component > limit.most)
      fail(value.value_place,
           label + " rgb component " + format_number(component) + ": " + at_most(limit.most, limit.unit));
  }
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return from_number(rgb[0], use);
  return load_at(value.value_place, [&] {
    if (is_emission(use)) return rgb_emission(rgb);
    const double brightest = std::max({rgb[0], rgb[1], rgb[2]});
    if (use == SpectrumUse::kReflectance || (use == SpectrumUse::kColour && brightest <= 1))
      return rgb_reflectance(rgb);
    const double scale = use == SpectrumUse::kColour ? brightest : 2 * brightest;
    return rgb_reflectance({rgb[0] / scale, rgb[1] / scale, rgb[2] / scale}).scaled(scale);
  });
}

/// "400:0.1, 500:0.2": wavelengths in nm, strictly increasing.
Spectrum from_pairs(const XmlAttribute& value, const std::string& context) {
  std::vector<double> lambda, values;
  for (const std::string_view token : split_tokens(value.value)) {
    const std::size_t colon = token.find(':');
    if (colon == std::string_view::npos || colon == 0 || colon + 1 == token.size()) {
      fail(value.value_place, context + "'" + std::string(token.substr(0, 40)) +
                                  "' is not a pair wavelength:value (no blanks around ':')");
    }
    lambda.push_back(parse_number(token.substr(0, colon), value.value_place, context));
    values.push_back(parse_number(token.substr(colon + 1), value.value_place, context));
    if (!(lambda.back() > 0))
      fail(value.value_place, context + "wavelength " + format_number(lambda.back()) + " nm: must be > 0");
    if (lambda.size() > 1 && !(lambda.back() > lambda[lambda.size() - 2])) {
      fail(value.value_place, context + "wavelength " + format_number(lambda.back()) + " nm after " +
                                  format_number(lambda[lambda.size() - 2]) + " nm: must increase strictly");
    }
  }
  if (lambda.size() < 2)
    fail(value.value_place, context + "a spectrum needs at least 2 pairs wavelength:value");
  return Spectrum::tabulated(std::move(lambda), std::move(values));
}

/// <spectrum value= | filename=>. A single number is flat, on emitters too.
Spectrum from_spectrum(ReadContext& context, const Node& node, const std::string& label, SpectrumUse use) {
  if (const XmlAttribute* filename = node.find("filename")) {
    const std::filesystem::path file = find_file(context.tree, filename->value, filename->value_place);
    return load_at(filename->value_place, [&] { return read_used_file(context, file, use); });
  }
  const XmlAttribute& value = *node.find("value");
  if (value.value.find(':') != std::string::npos) return from_pairs(value, label + ": ");
  return Spectrum::constant(parse_number(value.value, value.value_place, label + ": "));
}

Texture from_object(ReadContext& context, Node& node, const std::string& label, SpectrumUse use) {
  if (auto spectrum = read_spectrum_object(context, node, use)) return *spectrum;
  Texture texture = read_texture_object(context, node);
  if (use == SpectrumUse::kQuantity || use == SpectrumUse::kIndex || use == SpectrumUse::kAbsorption)
    fail(node.type_place, label + ": a texture is not supported here");
  return texture;
}

}  // namespace

bool is_emission(SpectrumUse use) {
  return use == SpectrumUse::kEmission || use == SpectrumUse::kIrradiance || use == SpectrumUse::kIntensity;
}

Spectrum read_used_file(ReadContext& context, const std::filesystem::path& file, SpectrumUse use) {
  const std::pair<std::filesystem::path, int> key(file, static_cast<int>(use));
  const auto known = context.spectrum_files.find(key);
  if (known != context.spectrum_files.end()) return known->second;
  return context.spectrum_files.emplace(key, read_spectrum_file(file, kind_of(use), context.sink))
      .first->second;
}

void check_spectrum(const Spectrum& spectrum, const std::string& label, SpectrumUse use, const Place& place) {
  const auto lambda = spectrum.knots_nm();
  const auto values = spectrum.knot_values();
  for (std::size_t i = 0; i < lambda.size(); ++i) {
    if (is_allowed(values[i], use)) continue;
    fail(place, label + " " + format_number(values[i]) + " at " + format_number(lambda[i]) +
                    " nm: " + std::string(rule(use)));
  }
  const double value = spectrum.is_constant() ? spectrum(550) : 0;
  if (!is_allowed(value, use))
    fail(place, label + " " + format_number(value) + ": " + std::string(rule(use)));
  check_peak(spectrum, label, use, place);
}

Texture read_texture_node(ReadContext& context, Node& parameter, const std::string& label, SpectrumUse use) {
  Node& node = parameter.resolved();
  node.used = true;
  const Place place = place_of_value(parameter);
  if (node.tag == "float" || node.tag == "integer") {
    const XmlAttribute& value = *node.find("value");
    const double number = node.tag == "float"
                              ? parse_number(value.value, place, label + ": ")
                              : static_cast<double>(parse_integer(value.value, place, label + ": "));
    return checked_number(number, label, use, place);
  }
  if (node.tag == "rgb") return from_rgb(*node.find("value"), label, use);
  const bool is_object = node.kind == TagKind::kObject;
  if (node.tag != "spectrum" && !(node.tag == "texture" && is_object)) {
    fail(place, label + ": expected a spectrum, found " + describe_kind(parameter));
  }
  const std::pair<const Node*, int> key(&node, static_cast<int>(use));
  if (const auto known = context.checked.find(key); known != context.checked.end()) return known->second;
  const Texture texture =
      is_object ? from_object(context, node, label, use) : Texture(from_spectrum(context, node, label, use));
  if (const auto* spectrum = std::get_if<Spectrum>(&texture)) {
    check_spectrum(*spectrum, label, use, place);
  } else if (use == SpectrumUse::kReflectance) {
    check_reflectance_texture(texture, label, place);
  } else {
    check_emission_texture(texture, label, place);
  }
  context.checked.emplace(key, texture);
  return texture;
}

Texture read_texture(ReadContext& context, const ObjectReader& object, std::string_view name, SpectrumUse use,
                     const Texture& fallback) {
  Node* node = object.find(name);
  if (!node) return fallback;
  Texture texture = read_texture_node(context, *node, object.label() + ": " + std::string(name), use);
  const auto* bitmap = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture);
  if (bitmap && (*bitmap)->raw && (*bitmap)->image->channels != 1)
    object.fail_at(name, std::string(name) + ": '" + (*bitmap)->file.filename().string() +
                             "' is raw and has three channels, which are no spectrum: leave raw out, or "
                             "give it one channel");
  return texture;
}

Spectrum read_spectrum(ReadContext& context, const ObjectReader& object, std::string_view name,
                       SpectrumUse use, const Spectrum& fallback) {
  const Texture texture = read_texture(context, object, name, use, fallback);
  if (const auto* spectrum = std::get_if<Spectrum>(&texture)) return *spectrum;
  object.fail_at(name, std::string(name) + ": a texture is not supported here");
}

}  // namespace kiloband
