#include "scene/read/ior.hpp"

#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"
#include "spectral/materials/materials.hpp"

namespace kiloband {
namespace {

struct NamedIndex {
  std::string_view name;
  double index;
};

/// Mitsuba 3's table of names, at 589.3 nm.
constexpr NamedIndex kIndices[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419}};

double named_index(const ObjectReader& object, std::string_view parameter, const std::string& name) {
  std::vector<std::string_view> known;
  for (const NamedIndex& entry : kIndices) {
    if (entry.name == name) return entry.index;
    known.push_back(entry.name);
  }
  object.fail_at(parameter,
                 std::string(parameter) + ": unknown material '" + name + "'" + suggestion(name, known));
}

/// The file that the value names; nullopt if it is to be a built-in name.
std::optional<std::filesystem::path> material_file(ReadContext& context, const std::string& value,
                                                   const Place& place) {
  const bool must_be_file = value.find_first_of("./") != std::string::npos;
  try {
    return find_file(context.tree, value, place);
  } catch (const InputError&) {
    if (must_be_file) throw;
    return std::nullopt;
  }
}

std::optional<OpticalConstants> find_built_in(std::string_view name, MaterialFamily family) {
  if (family == MaterialFamily::kMetal) return find_metal(name);
  const auto index = find_dielectric(name);
  return index ? std::optional(OpticalConstants{*index, std::nullopt}) : std::nullopt;
}

/// "; did you mean 'Au'?", or all names.
std::string names_near(const std::string& value, MaterialFamily family) {
  const auto materials = family == MaterialFamily::kMetal ? built_in_metals() : built_in_dielectrics();
  std::vector<std::string_view> names;
  std::string all;
  for (const BuiltInMaterial& material : materials) {
    names.push_back(material.name);
    all += (all.empty() ? "; there are " : ", ") + std::string(material.name);
  }
  const std::string near = suggestion(value, names);
  if (!near.empty() || value.size() < 3) return near.empty() ? all : near;
  for (const std::string_view name : names)
    if (lowered(name).find(lowered(value)) != std::string::npos)
      return "; did you mean '" + std::string(name) + "'?";
  return all;
}

[[noreturn]] void refuse_name(const ObjectReader& object, std::string_view name, const std::string& value,
                              MaterialFamily family) {
  const bool metal = family == MaterialFamily::kMetal;
  const std::string what = std::string(name) + ": '" + value + "' is ";
  if (find_built_in(value, metal ? MaterialFamily::kDielectric : MaterialFamily::kMetal))
    object.fail_at(name, what + (metal ? "a transparent material, not a metal" : "a metal, not transparent"));
  object.fail_at(name, what + "neither a built-in " + (metal ? "metal" : "transparent material") +
                           " nor a file" + names_near(value, family));
}

/// Every point of a table within [least, most].
void check_range(const Spectrum& spectrum, double least, double most, const std::string& label,
                 const Place& place) {
  for (std::size_t i = 0; i < spectrum.knots_nm().size(); ++i) {
    const double value = spectrum.knot_values()[i];
    if (value >= least && value <= most) continue;
    fail(place, label + " " + format_number(value) + " at " + format_number(spectrum.knots_nm()[i]) +
                    " nm: must be from " + format_number(least) + " to " + format_number(most));
  }
}

void check_index(const OpticalConstants& constants, MaterialFamily family, const std::string& label,
                 const Place& place) {
  const bool metal = family == MaterialFamily::kMetal;
  check_range(constants.n, metal ? 0 : kMinIndex, metal ? kMaxMetalIndex : kMaxIndex, label + " index",
              place);
  if (metal && constants.k) check_range(*constants.k, 0, kMaxMetalIndex, label + " extinction", place);
}

void extrapolate_if(bool asked, OpticalConstants& constants) {
  if (!asked) return;
  constants.n = constants.n.extrapolated();
  if (constants.k) constants.k = constants.k->extrapolated();
}

}  // namespace

void check_metal_index(const Spectrum& spectrum, const std::string& label, const Place& place) {
  check_range(spectrum, 0, kMaxMetalIndex, label, place);
  const double largest = spectrum.max_over(1, 1e9);
  if (largest > kMaxMetalIndex)
    fail(place, label + " " + format_number(largest) + ": " + at_most(kMaxMetalIndex));
}

double read_ior(const ObjectReader& object, std::string_view name, double fallback) {
  const Node* node = object.find(name);
  if (!node) return fallback;
  if (node->tag == "string") return named_index(object, name, object.get_string(name, {}));
  if (node->tag != "float") {
    object.fail_at(name, "parameter '" + std::string(name) +
                             "': expected a float or a material name, found " + describe_kind(*node));
  }
  const double index = object.get_float(name, fallback);
  object.check(index > 0, name, index, "must be > 0");
  object.check(index >= kMinIndex && index <= kMaxIndex, name, index, "must be from 0.001 to 1000");
  return index;
}

std::optional<OpticalConstants> read_material(ReadContext& context, const ObjectReader& object,
                                              std::string_view name, MaterialFamily family) {
  if (!object.has(name)) return std::nullopt;
  const bool extrapolates = object.get_bool("extrapolate", false);  // asked first: what follows may fail
  const std::string value = object.require_string(name);
  const Place place = object.value_place(name);
  std::optional<OpticalConstants> constants;
  if (const auto file = material_file(context, value, place)) {
    constants = load_at(place, [&] { return read_optical_constants(*file, context.sink); });
    check_index(*constants, family, object.label() + ": " + std::string(name), place);
    if (family == MaterialFamily::kMetal && !constants->k)
      object.fail_at(name, std::string(name) + ": the file gives no extinction k");
  } else {
    constants = find_built_in(value, family);
    if (!constants) refuse_name(object, name, value, family);
  }
  extrapolate_if(extrapolates, *constants);
  return constants;
}

std::optional<OpticalConstants> read_conductor_name(ReadContext& context, const ObjectReader& object) {
  const std::string material = object.get_string("material", "none");
  if (material == "none") return std::nullopt;
  const bool extrapolates = object.get_bool("extrapolate", false);
  constexpr std::string_view kOfPalik =
      "_palik";  // of Palik's handbook, where Mitsuba has data of two sources
  std::string metal = material;
  if (metal.ends_with(kOfPalik)) metal.resize(metal.size() - kOfPalik.size());
  auto constants = find_built_in(metal, MaterialFamily::kMetal);
  if (!constants) {
    object.fail_at("material", "material: no data of '" + material + "' are built in" +
                                   names_near(metal, MaterialFamily::kMetal) +
                                   "; 'metal' takes a file of n and k");
  }
  note(context.sink, object.value_place("material").position(),
       object.label() + ": material '" + material + "': n and k are kiloband's own data of this metal");
  extrapolate_if(extrapolates, *constants);
  return constants;
}

void read_metal(ReadContext& context, const ObjectReader& object, ConductorBsdf& bsdf) {
  const bool explicit_index = object.has("eta") || object.has("k");
  bsdf.eta = read_spectrum(context, object, "eta", SpectrumUse::kIndex, bsdf.eta);
  bsdf.k = read_spectrum(context, object, "k", SpectrumUse::kIndex, bsdf.k);
  check_metal_index(bsdf.eta, object.label() + ": eta", object.value_place("eta"));
  check_metal_index(bsdf.k, object.label() + ": k", object.value_place("k"));
  if (object.has("material") && explicit_index)
    object.fail_at("material", "'material' together with 'eta' or 'k'");
  auto constants = read_conductor_name(context, object);
  if (object.has("metal")) {
    if (explicit_index || object.has("material"))
      object.fail_at("metal", "'metal' together with 'material', 'eta' or 'k'");
    constants = read_material(context, object, "metal", MaterialFamily::kMetal);
  }
  if (!constants) return;
  bsdf.eta = constants->n;
  bsdf.k = *constants->k;
  bsdf.material = object.get_string(object.has("metal") ? "metal" : "material", {});
}

}  // namespace kiloband
