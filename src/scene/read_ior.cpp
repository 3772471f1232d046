#include "scene/read_ior.hpp"

#include "scene/xml_values.hpp"

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

}  // namespace

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
  return index;
}

std::optional<OpticalConstants> read_material_file(ReadContext& context, const ObjectReader& object,
                                                   std::string_view name) {
  if (!object.has(name)) return std::nullopt;
  const std::string file_name = object.require_string(name);
  const Place place = object.value_place(name);
  const std::filesystem::path file = [&] {
    try {
      return find_file(context.tree, file_name, place);
    } catch (const InputError&) {
      object.fail_at(
          name, std::string(name) + ": file '" + file_name + "' not found (there are no built-in materials)");
    }
  }();
  OpticalConstants constants = load_at(place, [&] { return read_optical_constants(file, context.sink); });
  const std::string label = object.label() + ": " + std::string(name);
  for (std::size_t i = 0; i < constants.n.knots_nm().size(); ++i) {
    if (constants.n.knot_values()[i] > 0) continue;
    fail(place, label + " index " + format_number(constants.n.knot_values()[i]) + " at " +
                    format_number(constants.n.knots_nm()[i]) + " nm: must be > 0");
  }
  if (constants.k) check_spectrum(*constants.k, label + " extinction", SpectrumUse::kQuantity, place);
  return constants;
}

}  // namespace kiloband
