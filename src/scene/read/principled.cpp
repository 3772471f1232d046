#include "scene/read/principled.hpp"

#include <cmath>

#include "scene/read/ior.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

constexpr NumberRange kShare{0, 1, "must be from 0 to 1"};
constexpr NumberRange kDoubleShare{0, 2, "must be from 0 to 2"};
constexpr NumberRange kEta{1, 10, "must be from 1 to 10"};
constexpr NumberRange kSpecular{0, 10, "must be from 0 to 10"};
constexpr NumberRange kRate{0, 1e6, "must be from 0 to 1e+06"};

double read_number(const ObjectReader& object, std::string_view name, double fallback,
                   const NumberRange& range) {
  const double number = object.get_float(name, fallback);
  object.check(number >= range.min && number <= range.max, name, number, range.rule);
  return number;
}

MappedNumber read_mapped(ReadContext& context, const ObjectReader& object, std::string_view name,
                         double fallback, const NumberRange& range) {
  MappedNumber result;
  result.map = read_number_map(context, object, name, range);
  if (!result.map) result.number = read_number(object, name, fallback, range);
  return result;
}

/// The index of a reflectance of 0.08 specular at normal incidence.
double eta_of(double specular) {
  return 2 / (1 - std::sqrt(0.08 * specular)) - 1;
}

/// eta or specular. Where light is refracted the two sides have different indices.
double read_thick_eta(const ObjectReader& object, bool refracts) {
  if (object.has("eta") && object.has("specular"))
    object.fail_at("specular", "'specular' together with 'eta'");
  if (object.has("eta")) {
    const double eta = read_ior(object, "eta", 1.5);
    object.check(eta >= kEta.min && eta <= kEta.max, "eta", eta, kEta.rule);
    return refracts ? std::max(eta, 1.001) : eta;
  }
  const double specular = read_number(object, "specular", 0.5, kSpecular);
  return eta_of(refracts ? std::max(specular, 0.001) : specular);
}

void read_rates(const ObjectReader& object, PrincipledBsdf& bsdf) {
  constexpr std::array kThick{"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate",
                              "clearcoat_sampling_rate"};
  constexpr std::array kThin{"diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
                             "specular_transmittance_sampling_rate", "diffuse_transmittance_sampling_rate"};
  const auto read = [&](const auto& names) {
    for (std::size_t i = 0; i < names.size(); ++i) bsdf.rates[i] = read_number(object, names[i], 1, kRate);
  };
  bsdf.thin ? read(kThin) : read(kThick);
}

}  // namespace

std::shared_ptr<const BitmapTexture> read_number_map(ReadContext& context, const ObjectReader& object,
                                                     std::string_view name, const NumberRange& range) {
  Node* node = object.find(name);
  if (!node || node->resolved().kind != TagKind::kObject) return nullptr;
  node->resolved().used = true;
  const Texture texture = read_texture_object(context, node->resolved());
  const auto* found = std::get_if<std::shared_ptr<const BitmapTexture>>(&texture);
  const auto bitmap = found ? *found : number_board(texture);
  if (!bitmap)
    object.fail_at(
        name, std::string(name) + ": only a number, a bitmap or a checkerboard of numbers is supported here");
  for (const float value : bitmap->image->pixels)
    if (!(value >= range.min && value <= range.max))
      object.fail_at(name, std::string(name) + ": a value of '" + bitmap->file.filename().string() + "' is " +
                               format_number(value) + ": " + range.rule);
  return bitmap;
}

PrincipledBsdf read_principled(ReadContext& context, const ObjectReader& object, bool thin) {
  PrincipledBsdf bsdf;
  bsdf.thin = thin;
  bsdf.base_color =
      read_texture(context, object, "base_color", SpectrumUse::kReflectance, Texture(bsdf.base_color));
  const auto read = [&](KbPrincipledNumber number, const char* name, double fallback,
                        const NumberRange& range) {
    bsdf.numbers[number] = read_mapped(context, object, name, fallback, range);
  };
  read(KB_PRINCIPLED_ROUGHNESS, "roughness", 0.5, kShare);
  read(KB_PRINCIPLED_ANISOTROPIC, "anisotropic", 0, kShare);
  read(KB_PRINCIPLED_SPEC_TRANS, "spec_trans", 0, kShare);
  read(KB_PRINCIPLED_SPEC_TINT, "spec_tint", 0, kShare);
  read(KB_PRINCIPLED_SHEEN, "sheen", 0, kShare);
  read(KB_PRINCIPLED_SHEEN_TINT, "sheen_tint", 0, kShare);
  read(KB_PRINCIPLED_FLATNESS, "flatness", 0, kShare);
  if (thin) {
    read(KB_PRINCIPLED_ETA, "eta", 1.5, kEta);
    read(KB_PRINCIPLED_DIFF_TRANS, "diff_trans", 0, kDoubleShare);
  } else {
    read(KB_PRINCIPLED_METALLIC, "metallic", 0, kShare);
    read(KB_PRINCIPLED_CLEARCOAT, "clearcoat", 0, kShare);
    read(KB_PRINCIPLED_CLEARCOAT_GLOSS, "clearcoat_gloss", 0, kShare);
    const MappedNumber& trans = bsdf.numbers[KB_PRINCIPLED_SPEC_TRANS];
    bsdf.numbers[KB_PRINCIPLED_ETA].number = read_thick_eta(object, trans.map || trans.number > 0);
  }
  read_rates(object, bsdf);
  return bsdf;
}

}  // namespace kiloband
