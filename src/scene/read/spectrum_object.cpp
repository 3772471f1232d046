// <spectrum type=...> objects: regular, irregular, uniform, blackbody, d65, srgb,
// and our own planck and file.
#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"
#include "spectral/colour/colour.hpp"
#include "spectral/colour/rgb.hpp"

namespace kiloband {
namespace {

std::vector<double> number_list(const ObjectReader& object, std::string_view name) {
  const std::string text = object.require_string(name);
  return parse_numbers(text, object.value_place(name), object.label() + ": " + std::string(name) + ": ");
}

Spectrum tabulated(const ObjectReader& object, std::vector<double> lambda, std::vector<double> values,
                   std::string_view where) {
  const bool extrapolate = object.get_bool("extrapolate", false);
  return load_at(object.value_place(where),
                 [&] { return Spectrum::tabulated(std::move(lambda), std::move(values), extrapolate); });
}

Spectrum read_regular(ReadContext&, const ObjectReader& object, SpectrumUse) {
  const double low = object.require_float("wavelength_min");
  const double high = object.require_float("wavelength_max");
  std::vector<double> values = number_list(object, "values");
  object.check(low > 0, "wavelength_min", low, "must be > 0 nm");
  object.check(high > low, "wavelength_max", high, "must be larger than wavelength_min");
  if (values.size() < 2) object.fail_at("values", "values: at least 2 are needed");
  std::vector<double> lambda(values.size());
  const double step = (high - low) / static_cast<double>(values.size() - 1);
  for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] = low + static_cast<double>(i) * step;
  lambda.back() = high;
  return tabulated(object, std::move(lambda), std::move(values), "values");
}

Spectrum read_irregular(ReadContext&, const ObjectReader& object, SpectrumUse) {
  std::vector<double> lambda = number_list(object, "wavelengths");
  std::vector<double> values = number_list(object, "values");
  if (lambda.size() != values.size()) {
    object.fail_at("values", std::to_string(values.size()) + " values for " + std::to_string(lambda.size()) +
                                 " wavelengths");
  }
  if (lambda.size() < 2) object.fail_at("wavelengths", "wavelengths: at least 2 are needed");
  object.check(lambda[0] > 0, "wavelengths", lambda[0], "must be > 0 nm");
  for (std::size_t i = 1; i < lambda.size(); ++i) {
    object.check(lambda[i] > lambda[i - 1], "wavelengths", lambda[i], "must increase strictly");
  }
  return tabulated(object, std::move(lambda), std::move(values), "wavelengths");
}

/// Flat at every wavelength: as in Mitsuba the range only concerns how Mitsuba samples.
Spectrum read_uniform(ReadContext&, const ObjectReader& object, SpectrumUse) {
  object.get_float("wavelength_min", 360);
  object.get_float("wavelength_max", 830);
  return Spectrum::constant(object.get_float("value", 1));
}

/// A number that Mitsuba does not turn into a colour.
Spectrum read_raw_constant(ReadContext&, const ObjectReader& object, SpectrumUse) {
  return Spectrum::constant(object.require_float("value"));
}

double temperature(const ObjectReader& object) {
  const double kelvin = object.require_float("temperature");
  object.check(kelvin >= 0, "temperature", kelvin, "must be >= 0 K");
  check_at_most(object, "temperature", kelvin, kMaxTemperatureK, "K");
  return kelvin;
}

Spectrum read_blackbody(ReadContext&, const ObjectReader& object, SpectrumUse) {
  const double low = object.get_float("wavelength_min", kCieMinNm);
  const double high = object.get_float("wavelength_max", kCieMaxNm);
  object.check(low > 0, "wavelength_min", low, "must be > 0 nm");
  object.check(high > low, "wavelength_max", high, "must be larger than wavelength_min");
  return Spectrum::planck(temperature(object), 1, Spectrum::Range{low, high});
}

Spectrum read_planck(ReadContext&, const ObjectReader& object, SpectrumUse) {
  const double scale = object.get_float("scale", 1);
  object.check(scale >= 0, "scale", scale, "must be >= 0");
  check_at_most(object, "scale", scale, kMaxQuantity);
  return Spectrum::planck(temperature(object), scale);
}

/// Our own: a spectrum file as an object, so that `extrapolate` can be stated.
Spectrum read_file(ReadContext& context, const ObjectReader& object, SpectrumUse use) {
  const bool extrapolates = object.get_bool("extrapolate", false);
  const std::filesystem::path file = context.file(object, "filename");
  const Spectrum spectrum =
      load_at(object.value_place("filename"), [&] { return read_used_file(context, file, use); });
  return extrapolates ? spectrum.extrapolated() : spectrum;
}

/// A colour as it stands, the same spectrum wherever it is used: D65 comes from `d65` only.
Spectrum read_srgb(ReadContext& context, const ObjectReader& object, SpectrumUse use) {
  const Node* color = object.find("color");
  if (!color) object.fail_here("parameter 'color' is missing");
  if (color->tag != "rgb") object.fail_at("color", "color: expected an rgb, found " + describe_kind(*color));
  const bool reflectance = use == SpectrumUse::kReflectance;
  return read_spectrum(context, object, "color", reflectance ? use : SpectrumUse::kColour, Spectrum());
}

/// The one texture or spectrum nested in d65, by any name.
Node* nested_texture(const ObjectReader& object) {
  Node* texture = object.nested_one("texture");
  Node* spectrum = object.nested_one("spectrum");
  if (texture && spectrum) object.fail_here("more than one nested texture");
  return texture ? texture : spectrum;
}

/// D65 times `scale` and a colour or a nested texture. A nested bitmap stays one: on emitters it is
/// multiplied by D65.
Texture read_d65(ReadContext& context, const ObjectReader& object) {
  const double scale = object.get_float("scale", 1);
  object.check(scale >= 0, "scale", scale, "must be >= 0");
  check_at_most(object, "scale", scale, kMaxQuantity);
  Node* nested = nested_texture(object);
  Node* color = object.find("color");
  if (nested && color && &color->resolved() != nested) object.fail_here("both 'color' and a nested texture");
  if (!nested) {
    if (!color) return illuminant_d65().scaled(scale);
    // It has no D65 of its own, as numbers and colours of emission have.
    if (color->resolved().tag == "spectrum") {
      const Spectrum own = read_spectrum(context, object, "color", SpectrumUse::kAny, Spectrum());
      return Spectrum::product(illuminant_d65(), own).scaled(scale);
    }
    return read_spectrum(context, object, "color", SpectrumUse::kEmission, Spectrum()).scaled(scale);
  }
  const Texture inner =
      read_texture_node(context, *nested, object.label() + ": nested texture", SpectrumUse::kAny);
  if (const auto* spectrum = std::get_if<Spectrum>(&inner))
    return Spectrum::product(illuminant_d65(), *spectrum).scaled(scale);
  const auto* bitmap = std::get_if<std::shared_ptr<const BitmapTexture>>(&inner);
  if (!bitmap)
    fail(nested->type_place, object.label() + ": a nested " + nested->resolved().type + " is not supported");
  if ((*bitmap)->raw) fail(nested->type_place, object.label() + ": a nested raw bitmap is not supported");
  object.check(scale == 1, "scale", scale, "must be 1 with a nested bitmap");
  return inner;
}

struct SpectrumType {
  std::string_view name;
  bool emission_only;
  Spectrum (*read)(ReadContext&, const ObjectReader&, SpectrumUse);  // null: d65, which may give a texture
};

constexpr SpectrumType kSpectrumTypes[] = {{"regular", false, read_regular},
                                           {"irregular", false, read_irregular},
                                           {"uniform", false, read_uniform},
                                           {"blackbody", true, read_blackbody},
                                           {"planck", true, read_planck},
                                           {"d65", true, nullptr},
                                           {"srgb", false, read_srgb},
                                           {"file", false, read_file},
                                           {"rawconstant", false, read_raw_constant}};

}  // namespace

std::optional<Texture> read_spectrum_object(ReadContext& context, Node& node, SpectrumUse use) {
  const ObjectReader object(node);
  std::vector<std::string_view> known = {"bitmap", "checkerboard", "spectral_bitmap", "mesh_attribute"};
  for (const SpectrumType& type : kSpectrumTypes) {
    known.push_back(type.name);
    if (object.type() != type.name) continue;
    if (type.emission_only && use == SpectrumUse::kReflectance)
      fail(node.type_place, object.label() + " describes emission: not allowed as a reflectance");
    if (type.emission_only && use == SpectrumUse::kAbsorption)
      fail(node.type_place, object.label() + " describes emission: not allowed as an absorption");
    const Texture result = type.read ? Texture(type.read(context, object, use)) : read_d65(context, object);
    object.finish();
    return result;
  }
  if (object.type() == "bitmap" || object.type() == "checkerboard" || object.type() == "spectral_bitmap" ||
      object.type() == "mesh_attribute")
    return std::nullopt;
  object.refuse_type(known);
}

}  // namespace kiloband
