// <bsdf type=...>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene/read/context.hpp"
#include "scene/read/ior.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/read/principled.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

using BsdfModel = decltype(Bsdf::model);

void check_alpha(const ObjectReader& object, std::string_view name, double alpha) {
  object.check(alpha > 0, name, alpha, "must be > 0");
  object.check(alpha >= kMinAlpha && alpha <= kMaxAlpha, name, alpha, "must be from 1e-06 to 100");
}

/// An alpha: a number, or null and a bitmap of them.
std::shared_ptr<const BitmapTexture> read_alpha(ReadContext& context, const ObjectReader& object,
                                                std::string_view name, double& alpha) {
  auto map = read_number_map(context, object, name, {0, kMaxAlpha, "must be from 0 to 100"});
  if (map) return map;
  alpha = object.get_float(name, alpha);
  check_alpha(object, name, alpha);
  return nullptr;
}

/// distribution and sample_visible.
Roughness read_distribution(const ObjectReader& object) {
  Roughness result;
  result.distribution =
      object.get_choice("distribution", {"beckmann", "ggx"}) == 1 ? Microfacet::kGgx : Microfacet::kBeckmann;
  result.sample_visible = object.get_bool("sample_visible", true);
  return result;
}

/// And alpha, or alpha_u and alpha_v. One alpha: isotropic.
Roughness read_roughness(ReadContext& context, const ObjectReader& object) {
  Roughness result = read_distribution(object);
  if (!object.has("alpha_u") && !object.has("alpha_v")) {
    result.map_u = result.map_v = read_alpha(context, object, "alpha", result.alpha_u);
    result.alpha_v = result.alpha_u;
    return result;
  }
  if (object.has("alpha")) object.fail_at("alpha", "'alpha' together with 'alpha_u' or 'alpha_v'");
  for (const char* name : {"alpha_u", "alpha_v"})
    if (!object.has(name)) object.require_float(name);
  result.map_u = read_alpha(context, object, "alpha_u", result.alpha_u);
  result.map_v = read_alpha(context, object, "alpha_v", result.alpha_v);
  return result;
}

/// Of a plastic: one number, which its tables are made for.
Roughness read_plastic_roughness(const ObjectReader& object) {
  Roughness result = read_distribution(object);
  result.alpha_u = result.alpha_v = object.get_float("alpha", 0.1);
  check_alpha(object, "alpha", result.alpha_u);
  return result;
}

Texture reflectance(ReadContext& context, const ObjectReader& object, std::string_view name,
                    const Texture& fallback) {
  return read_texture(context, object, name, SpectrumUse::kReflectance, fallback);
}

BsdfModel read_diffuse(ReadContext& context, const ObjectReader& object) {
  DiffuseBsdf bsdf;
  bsdf.reflectance = reflectance(context, object, "reflectance", bsdf.reflectance);
  return bsdf;
}

BsdfModel read_conductor(ReadContext& context, const ObjectReader& object, bool rough) {
  ConductorBsdf bsdf;
  read_metal(context, object, bsdf);
  bsdf.specular_reflectance = reflectance(context, object, "specular_reflectance", bsdf.specular_reflectance);
  if (rough) bsdf.roughness = read_roughness(context, object);
  if (object.node().legacy && object.has("ext_eta")) {
    const double outside = read_ior(object, "ext_eta", 1);
    object.check(outside > 0.999 && outside < 1.001, "ext_eta", outside,
                 "conductors stand in air here (1): divide eta and k by it");
  }
  return bsdf;
}

/// int_ior or int_material (the same for ext): a constant or a dispersive index.
OpticalConstants read_index(ReadContext& context, const ObjectReader& object, std::string_view ior,
                            std::string_view material, double fallback) {
  const double index = read_ior(object, ior, fallback);
  const auto constants = read_material(context, object, material, MaterialFamily::kDielectric);
  if (!constants) return {Spectrum::constant(index), std::nullopt};
  if (object.has(ior)) {
    object.fail_at(material, "'" + std::string(material) + "' together with '" + std::string(ior) + "'");
  }
  return *constants;
}

/// The material that read_index() takes; empty: it takes a number.
std::string name_of_index(const ObjectReader& object, std::string_view ior, std::string_view material) {
  const Node* const index = object.find(ior);
  if (index && index->tag == "string") return object.get_string(ior, {});
  return object.get_string(material, {});
}

DielectricBsdf read_dielectric(ReadContext& context, const ObjectReader& object, bool rough) {
  DielectricBsdf bsdf;
  const OpticalConstants inside = read_index(context, object, "int_ior", "int_material", 1.5046);
  bsdf.int_ior = inside.n;
  bsdf.int_k = inside.k;
  bsdf.ext_ior = read_index(context, object, "ext_ior", "ext_material", 1.000277).n;
  bsdf.material = name_of_index(object, "int_ior", "int_material");
  bsdf.specular_reflectance = reflectance(context, object, "specular_reflectance", bsdf.specular_reflectance);
  bsdf.specular_transmittance =
      reflectance(context, object, "specular_transmittance", bsdf.specular_transmittance);
  if (!rough) return bsdf;
  bsdf.roughness = read_roughness(context, object);
  if (bsdf.int_ior.is_constant() && bsdf.ext_ior.is_constant() && bsdf.int_ior(550) == bsdf.ext_ior(550)) {
    object.fail_at("int_ior", "int_ior and ext_ior are equal: there is no rough interface");
  }
  return bsdf;
}

BsdfModel read_plastic(ReadContext& context, const ObjectReader& object, bool rough) {
  PlasticBsdf bsdf;
  bsdf.diffuse_reflectance = reflectance(context, object, "diffuse_reflectance", bsdf.diffuse_reflectance);
  bsdf.specular_reflectance = reflectance(context, object, "specular_reflectance", bsdf.specular_reflectance);
  bsdf.int_ior = read_ior(object, "int_ior", bsdf.int_ior);
  bsdf.ext_ior = read_ior(object, "ext_ior", bsdf.ext_ior);
  bsdf.nonlinear = object.get_bool("nonlinear", false);
  if (rough) bsdf.roughness = read_plastic_roughness(object);
  return bsdf;
}

BsdfModel read_principled_thick(ReadContext& c, const ObjectReader& o) {
  return read_principled(c, o, false);
}
BsdfModel read_principled_thin(ReadContext& c, const ObjectReader& o) {
  return read_principled(c, o, true);
}

/// Is the model, or one that is blended in it, of this kind?
template <class Kind>
bool contains(const Bsdf& bsdf) {
  const auto* bumped = std::get_if<BumpedBsdf>(&bsdf.model);
  if (bumped && !std::is_same_v<Kind, BumpedBsdf>) return contains<Kind>(*bumped->nested);
  const auto* blend = std::get_if<BlendBsdf>(&bsdf.model);
  return blend ? contains<Kind>(*blend->first) || contains<Kind>(*blend->second)
               : std::holds_alternative<Kind>(bsdf.model);
}

bool transmits(const Bsdf& bsdf) {
  if (const auto* principled = std::get_if<PrincipledBsdf>(&bsdf.model)) return passes_light(*principled);
  if (const auto* bumped = std::get_if<BumpedBsdf>(&bsdf.model)) return transmits(*bumped->nested);
  if (const auto* blend = std::get_if<BlendBsdf>(&bsdf.model))
    return transmits(*blend->first) || transmits(*blend->second);
  return contains<DielectricBsdf>(bsdf) || contains<MaskBsdf>(bsdf) || contains<NullBsdf>(bsdf);
}

BsdfModel read_two_sided(ReadContext& context, const ObjectReader& object) {
  const std::vector<Node*> nested = object.nested("bsdf");
  if (nested.empty() || nested.size() > 2) {
    object.fail_here("needs 1 or 2 nested bsdfs, found " + std::to_string(nested.size()));
  }
  TwoSidedBsdf bsdf;
  for (std::size_t i = 0; i < nested.size(); ++i) {
    auto side = read_bsdf(context, *nested[i]);
    if (transmits(*side))
      object.fail_here("the nested " + ObjectReader(*nested[i]).label() + " transmits light");
    if (contains<TwoSidedBsdf>(*side)) object.fail_here("a nested bsdf is twosided itself");
    (i == 0 ? bsdf.front : bsdf.back) = std::move(side);
  }
  return bsdf;
}

BsdfModel read_mask(ReadContext& context, const ObjectReader& object) {
  MaskBsdf bsdf;
  bsdf.opacity = read_share(context, object, "opacity", bsdf.opacity);
  Node* nested = object.nested_one("bsdf");
  if (!nested) object.fail_here("needs a nested bsdf");
  bsdf.nested = read_bsdf(context, *nested);
  if (contains<MaskBsdf>(*bsdf.nested)) object.fail_here("the nested bsdf is a mask itself");
  if (std::holds_alternative<NullBsdf>(bsdf.nested->model)) return NullBsdf{};  // rays pass either way
  return bsdf;
}

BsdfModel read_blend(ReadContext& context, const ObjectReader& object) {
  BlendBsdf bsdf;
  if (!object.has("weight")) object.fail_here("needs a weight");
  bsdf.weight = read_share(context, object, "weight", bsdf.weight);
  const std::vector<Node*> nested = object.nested("bsdf");
  if (nested.size() != 2) object.fail_here("needs 2 nested bsdfs, found " + std::to_string(nested.size()));
  bsdf.first = read_bsdf(context, *nested[0]);
  bsdf.second = read_bsdf(context, *nested[1]);
  for (const auto& part : {bsdf.first, bsdf.second}) {
    if (contains<NullBsdf>(*part))
      object.fail_here("a nested bsdf is null: a mask with the weight of the other as opacity is the same");
  }
  return bsdf;
}

/// Parts of which each is as likely as its weight says, as blends one inside the other.
BsdfModel nested_blends(const SourcePosition& position, const std::vector<std::shared_ptr<const Bsdf>>& parts,
                        const std::vector<double>& weights) {
  std::shared_ptr<const Bsdf> rest = parts.back();
  double weight_of_rest = weights.back();
  for (std::size_t i = parts.size() - 1; i-- > 0;) {
    const double both = weights[i] + weight_of_rest;
    const double share = both > 0 ? weight_of_rest / both : 0;
    rest = std::make_shared<Bsdf>(Bsdf{{}, position, BlendBsdf{Spectrum::constant(share), parts[i], rest}});
    weight_of_rest = both;
  }
  return rest->model;
}

/// Of files of Mitsuba 0.x: any number of bsdfs with a weight each. Weights of a sum above 1 are divided by it, what a sum below
/// leaves to 1 is absorbed.
BsdfModel read_mixture(ReadContext& context, const ObjectReader& object) {
  std::vector<double> weights = parse_numbers(object.require_string("weights"), object.value_place("weights"),
                                              object.label() + ": weights: ");
  const std::vector<Node*> nested = object.nested("bsdf");
  if (!object.is_whole()) weights.resize(nested.size(), 1);
  if (nested.empty() || weights.size() != nested.size())
    object.fail_at("weights", std::to_string(weights.size()) + " weights for " +
                                  std::to_string(nested.size()) + " nested bsdfs");
  for (const double weight : weights) object.check(weight >= 0, "weights", weight, "must be >= 0");
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  object.check(sum > 0, "weights", sum, "must have a sum > 0");
  std::vector<std::shared_ptr<const Bsdf>> parts;
  for (Node* node : nested) {
    parts.push_back(read_bsdf(context, *node));
    if (contains<NullBsdf>(*parts.back())) object.fail_here("a nested bsdf is null");
  }
  const SourcePosition position = object.node().place.position();
  if (sum < 1) {
    parts.push_back(std::make_shared<Bsdf>(Bsdf{{}, position, DiffuseBsdf{Spectrum::constant(0)}}));
    weights.push_back(1 - sum);
  }
  return nested_blends(position, parts, weights);
}

BsdfModel read_conductor_smooth(ReadContext& c, const ObjectReader& o) {
  return read_conductor(c, o, false);
}
BsdfModel read_conductor_rough(ReadContext& c, const ObjectReader& o) {
  return read_conductor(c, o, true);
}
BsdfModel read_dielectric_smooth(ReadContext& c, const ObjectReader& o) {
  return read_dielectric(c, o, false);
}
BsdfModel read_dielectric_rough(ReadContext& c, const ObjectReader& o) {
  return read_dielectric(c, o, true);
}
BsdfModel read_dielectric_thin(ReadContext& c, const ObjectReader& o) {
  DielectricBsdf bsdf = read_dielectric(c, o, false);
  bsdf.thin = true;
  return bsdf;
}
BsdfModel read_plastic_smooth(ReadContext& c, const ObjectReader& o) {
  return read_plastic(c, o, false);
}
BsdfModel read_plastic_rough(ReadContext& c, const ObjectReader& o) {
  return read_plastic(c, o, true);
}

BsdfModel read_null(ReadContext&, const ObjectReader&) {
  return NullBsdf{};
}

/// `bump` around a bsdf, moved inwards to what scatters: the same for twosided bsdfs, masks and blends.
std::shared_ptr<const Bsdf> bumped(const BumpedBsdf& bump, const std::shared_ptr<const Bsdf>& inner) {
  if (!inner || std::holds_alternative<NullBsdf>(inner->model)) return inner;
  BsdfModel model = inner->model;
  if (auto* sides = std::get_if<TwoSidedBsdf>(&model)) {
    BumpedBsdf around = bump;
    around.around_two_sided = true;
    sides->front = bumped(around, sides->front);
    sides->back = bumped(around, sides->back);
  } else if (auto* mask = std::get_if<MaskBsdf>(&model)) {
    mask->nested = bumped(bump, mask->nested);
  } else if (auto* blend = std::get_if<BlendBsdf>(&model)) {
    blend->first = bumped(bump, blend->first);
    blend->second = bumped(bump, blend->second);
  } else {
    BumpedBsdf leaf = bump;
    leaf.nested = inner;
    model = std::move(leaf);
  }
  return std::make_shared<Bsdf>(Bsdf{inner->id, inner->position, std::move(model)});
}

bool contains_bump(const Bsdf& bsdf) {
  if (const auto* sides = std::get_if<TwoSidedBsdf>(&bsdf.model))
    return contains_bump(*sides->front) || (sides->back && contains_bump(*sides->back));
  if (const auto* mask = std::get_if<MaskBsdf>(&bsdf.model)) return contains_bump(*mask->nested);
  if (const auto* blend = std::get_if<BlendBsdf>(&bsdf.model))
    return contains_bump(*blend->first) || contains_bump(*blend->second);
  return std::holds_alternative<BumpedBsdf>(bsdf.model);
}

/// The bitmap of a bumpmap or normalmap, which may have any name.
std::shared_ptr<const BitmapTexture> read_bump_texture(ReadContext& context, const ObjectReader& object) {
  Node* node = object.nested_one("texture");
  if (!node) object.fail_here("needs a nested texture");
  if (node->type != "bitmap") object.fail_here("the nested texture is no bitmap");
  const Texture texture = read_texture_object(context, *node);
  return std::get<std::shared_ptr<const BitmapTexture>>(texture);
}

BsdfModel read_bumped(ReadContext& context, const ObjectReader& object, bool normals) {
  BumpedBsdf bump;
  bump.normals = normals;
  bump.texture = read_bump_texture(context, object);
  if (!normals) {
    bump.scale = object.get_float("scale", 1);
    object.check(std::abs(bump.scale) <= kMaxBumpScale, "scale", bump.scale, "must be from -1e+06 to 1e+06");
  } else if (bump.texture->image->channels == 1) {
    object.fail_here("'" + bump.texture->file.filename().string() + "' has 1 channel, normals have 3");
  }
  bump.flip = object.get_bool("flip_invalid_normals", true);
  bump.shadow = object.get_bool("use_shadowing_function", true);
  Node* nested = object.nested_one("bsdf");
  if (!nested) object.fail_here("needs a nested bsdf");
  const auto inner = read_bsdf(context, *nested);
  if (contains_bump(*inner)) object.fail_here("there is a bumpmap or normalmap in the nested bsdf");
  return bumped(bump, inner)->model;
}

BsdfModel read_bump_map(ReadContext& c, const ObjectReader& o) {
  return read_bumped(c, o, false);
}
BsdfModel read_normal_map(ReadContext& c, const ObjectReader& o) {
  return read_bumped(c, o, true);
}

struct BsdfType {
  std::string_view name;
  BsdfModel (*read)(ReadContext&, const ObjectReader&);
};

constexpr BsdfType kBsdfTypes[] = {
    {"diffuse", read_diffuse},
    {"conductor", read_conductor_smooth},
    {"roughconductor", read_conductor_rough},
    {"dielectric", read_dielectric_smooth},
    {"roughdielectric", read_dielectric_rough},
    {"thindielectric", read_dielectric_thin},
    {"plastic", read_plastic_smooth},
    {"roughplastic", read_plastic_rough},
    {"principled", read_principled_thick},
    {"principledthin", read_principled_thin},
    {"twosided", read_two_sided},
    {"mask", read_mask},
    {"blendbsdf", read_blend},
    {"mixturebsdf", read_mixture},
    {"bumpmap", read_bump_map},
    {"normalmap", read_normal_map},
    {"null", read_null},
};

}  // namespace

std::shared_ptr<const Bsdf> read_bsdf(ReadContext& context, Node& node) {
  const auto known = context.bsdfs.find(&node);
  if (known != context.bsdfs.end()) return known->second;
  const ObjectReader object(node);
  const auto type = std::find_if(std::begin(kBsdfTypes), std::end(kBsdfTypes),
                                 [&](const BsdfType& t) { return t.name == node.type; });
  if (type == std::end(kBsdfTypes)) {
    std::vector<std::string_view> names;
    for (const BsdfType& t : kBsdfTypes) names.push_back(t.name);
    object.refuse_type(names);
  }
  auto bsdf = std::make_shared<Bsdf>(Bsdf{node.id, node.place.position(), type->read(context, object)});
  object.finish();
  context.bsdfs.emplace(&node, bsdf);
  return bsdf;
}

}  // namespace kiloband
