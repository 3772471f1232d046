// <medium type=...>: gases, homogeneous or as a plume.
#include <algorithm>
#include <cmath>

#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"
#include "spectral/files/number_table.hpp"
#include "spectral/files/text_table.hpp"

namespace kiloband {
namespace {

constexpr std::size_t kMaxGridNodes = std::size_t{1} << 26;
constexpr double kMinGasK = 1;  // colder gas does not exist, and hc / (k lambda T) would overflow
const char* const kGasRule = "must be from 1 to 100000 K";
constexpr double kMaxSpread = 1000;

double kelvin(const ObjectReader& object, std::string_view name) {
  const double value = object.require_float(name);
  object.check(value > 0, name, value, "must be > 0 K");
  object.check(value >= kMinGasK && value <= kMaxTemperatureK, name, value, kGasRule);
  return value;
}

double length(const ObjectReader& object, std::string_view name) {
  const double value = object.require_float(name);
  object.check(value > 0, name, value, "must be > 0 m");
  check_at_most(object, name, value, kMaxLength, "m");
  return value;
}

JetField read_jet(const ObjectReader& object) {
  JetField jet;
  jet.temperature_k = kelvin(object, "temperature");
  jet.ambient_k = kelvin(object, "ambient");
  jet.radius = length(object, "radius");
  jet.length = length(object, "length");
  jet.spread = object.get_float("spread", 0);
  object.check(jet.spread >= 0, "spread", jet.spread, "must be >= 0");
  check_at_most(object, "spread", jet.spread, kMaxSpread);
  jet.to_world = object.get_transform("to_world");
  return jet;
}

/// "nx, ny, nz".
std::array<uint32_t, 3> read_nodes(const ObjectReader& object) {
  const std::string text = object.require_string("nodes");
  const std::vector<double> numbers =
      parse_numbers(text, object.value_place("nodes"), object.label() + ": nodes: ");
  if (numbers.size() != 3)
    object.fail_at("nodes", "nodes: expected 3 numbers, found " + std::to_string(numbers.size()));
  std::array<uint32_t, 3> nodes{};
  double count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double n = numbers[axis];
    object.check(n >= 2 && n == std::floor(n), "nodes", n, "must be a whole number >= 2");
    count *= n;
    object.check(count <= kMaxGridNodes, "nodes", n, "more than 67108864 nodes in all");
    nodes[axis] = static_cast<uint32_t>(n);
  }
  return nodes;
}

/// A node per line: temperature in K and scale.
std::vector<GridField::Node> load_grid(const std::filesystem::path& file,
                                       const std::array<uint32_t, 3>& nodes) {
  const NumberTable table = parse_number_table(file, read_text_file(file), {2, 2, false});
  const std::size_t count = std::size_t{nodes[0]} * nodes[1] * nodes[2];
  if (table.rows() != count)
    throw InputError(file.string() + ": " + std::to_string(table.rows()) + " nodes: must be " +
                     std::to_string(count));
  std::vector<GridField::Node> values;
  for (std::size_t row = 0; row < count; ++row) {
    const auto temperature = static_cast<float>(table.at(row, 0)),
               scale = static_cast<float>(table.at(row, 1));
    if (!(temperature > 0) || !std::isfinite(temperature))
      throw InputError(at_line(file, table.lines[row],
                               "temperature " + format_number(table.at(row, 0)) + ": must be > 0 K"));
    if (temperature < kMinGasK || temperature > kMaxTemperatureK)
      throw InputError(at_line(file, table.lines[row],
                               "temperature " + format_number(table.at(row, 0)) + ": " + kGasRule));
    if (!(scale >= 0) || !std::isfinite(scale))
      throw InputError(
          at_line(file, table.lines[row], "scale " + format_number(table.at(row, 1)) + ": must be >= 0"));
    if (scale > kMaxAbsorptionScale)
      throw InputError(
          at_line(file, table.lines[row],
                  "scale " + format_number(table.at(row, 1)) + ": " + at_most(kMaxAbsorptionScale)));
    values.push_back({temperature, scale});
  }
  return values;
}

GridField read_grid(ReadContext& context, const ObjectReader& object) {
  GridField grid;
  grid.nodes = read_nodes(object);
  const std::filesystem::path file = context.file(object, "filename");
  grid.values = load_at(object.value_place("filename"), [&] { return load_grid(file, grid.nodes); });
  grid.to_world = object.get_transform("to_world");
  return grid;
}

/// What homogeneous gases and plumes have in common.
void read_gas(ReadContext& context, const ObjectReader& object, Medium& medium) {
  if (!object.has("absorption")) object.fail_here("parameter 'absorption' is missing");
  medium.absorption =
      read_spectrum(context, object, "absorption", SpectrumUse::kAbsorption, Spectrum::constant(0));
  medium.scale = object.get_float("scale", 1);
  object.check(medium.scale >= 0, "scale", medium.scale, "must be >= 0");
  check_at_most(object, "scale", medium.scale, kMaxAbsorptionScale);
  medium.spectrum = object.get_choice("spectral", {"sampled", "correlated_k"}) == 1
                        ? GasSpectrum::kCorrelatedK
                        : GasSpectrum::kSampled;
}

/// Mitsuba's medium where its albedo is 0: it absorbs alone.
void read_homogeneous(ReadContext& context, const ObjectReader& object, Medium& medium) {
  const Spectrum albedo =
      read_spectrum(context, object, "albedo", SpectrumUse::kReflectance, Spectrum::constant(0.75));
  if (albedo.max_over(1, 1e9) > 0)
    object.fail_at("albedo", "albedo: nothing scatters in a volume here: must be 0");
  medium.absorption =
      read_spectrum(context, object, "sigma_t", SpectrumUse::kAbsorption, Spectrum::constant(1));
  medium.scale = object.get_float("scale", 1);
  object.check(medium.scale >= 0, "scale", medium.scale, "must be >= 0");
  check_at_most(object, "scale", medium.scale, kMaxAbsorptionScale);
  object.get_bool("has_spectral_extinction", true);  // how Mitsuba samples
  object.get_bool("sample_emitters", true);
  object.nested_one("phase");  // nothing is scattered
}

/// The product of all factors of the absorption.
void check_absorption(const ObjectReader& object, const Medium& medium) {
  double node_scale = 1;
  if (const auto* grid = std::get_if<GridField>(&medium.field))
    for (const GridField::Node& node : grid->values) node_scale = std::max(node_scale, double{node.scale});
  const double largest = medium.absorption.max_over(1, 1e9) * medium.scale * node_scale;
  object.check(medium.scale * node_scale <= kMaxAbsorptionScale, "scale", medium.scale * node_scale,
               at_most(kMaxAbsorptionScale) + " with the field's scales");
  if (largest > kMaxAbsorption)
    object.fail_at("absorption", "absorption times scale " + format_number(largest) + ": " +
                                     at_most(kMaxAbsorption, "1/m"));
}

}  // namespace

std::shared_ptr<const Medium> read_medium(ReadContext& context, Node& node) {
  const auto known = context.media.find(&node);
  if (known != context.media.end()) return known->second;
  const ObjectReader object(node);
  auto medium = std::make_shared<Medium>();
  medium->id = node.id;
  medium->position = node.place.position();
  if (node.type == "absorbing") {
    read_gas(context, object, *medium);
    if (object.has("temperature")) medium->temperature_k = kelvin(object, "temperature");
  } else if (node.type == "plume") {
    read_gas(context, object, *medium);
    if (object.get_choice("field", {"jet", "grid"}) == 0)
      medium->field = read_jet(object);
    else
      medium->field = read_grid(context, object);
  } else if (node.type == "homogeneous") {
    read_homogeneous(context, object, *medium);
  } else {
    object.refuse_type({"absorbing", "plume", "homogeneous"});
  }
  check_absorption(object, *medium);
  object.finish();
  context.media.emplace(&node, medium);
  return medium;
}

std::shared_ptr<const Medium> read_interior(ReadContext& context, const ObjectReader& shape) {
  const std::vector<Node*> media = shape.nested("medium");
  if (media.empty()) return nullptr;
  for (const auto& child : shape.node().children) {
    if (child->resolved().tag != "medium" || child->name == "interior") continue;
    fail(child->place, shape.label() + ": a medium must be named 'interior'" +
                           (child->name == "exterior"
                                ? "; what is outside is the medium around the shape, or the atmosphere"
                                : ""));
  }
  return read_medium(context, *media.front());
}

}  // namespace kiloband
