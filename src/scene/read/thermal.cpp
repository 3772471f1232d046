// <emitter type="thermal">: in a shape, or directly under the scene (the ambient temperature).
#include <algorithm>

#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

bool is_temperature(double value) {
  return value >= 0 && value <= kMaxTemperatureK;  // false for NaN
}

/// Celsius in place of kelvins is dark, and nothing else is.
void warn_of_celsius(ReadContext& context, float hottest, const std::string& what, const Place& place) {
  constexpr float kColdK = 100;
  if (hottest > 0 && hottest <= kColdK)
    warn(context.sink, place.position(),
         what + " has no more than " + format_number(static_cast<double>(hottest)) +
             " K: kelvins are meant, not degrees Celsius");
}

/// A bitmap whose values are kelvins, whatever it says about colours.
std::shared_ptr<const BitmapTexture> read_temperature_image(ReadContext& context, const ObjectReader& object,
                                                            Node& parameter) {
  Node& node = parameter.resolved();
  const Place place = place_of_value(parameter);
  const std::string label = object.label() + ": temperature";
  if (node.type != "bitmap")
    fail(place, label + ": expected a float or a bitmap, found " + describe_kind(parameter));
  node.used = true;
  const Texture texture = read_texture_object(context, node);
  auto bitmap = std::make_shared<BitmapTexture>(*std::get<std::shared_ptr<const BitmapTexture>>(texture));
  bitmap->raw = true;
  bitmap->image = context.image(bitmap->file, true, place);
  const Image& image = *bitmap->image;
  const std::string file = "'" + bitmap->file.filename().string() + "'";
  if (image.channels != 1) {
    fail(place, label + ": an image of temperatures has one channel, " + file + " has " +
                    std::to_string(image.channels));
  }
  // What is a rounding error of light is none of a temperature.
  if (image.lowest < 0)
    fail(place, label + " " + format_number(static_cast<double>(image.lowest)) + " in " + file + ": " +
                    kTemperatureRule);
  const auto wrong = std::find_if_not(image.pixels.begin(), image.pixels.end(), is_temperature);
  const float hottest = image.pixels.empty() ? 0 : *std::ranges::max_element(image.pixels);
  if (hottest > 0 && hottest <= 1)
    fail(place, label + ": " + file + " has no more than " + format_number(static_cast<double>(hottest)) +
                    " K: images of integers hold fractions of 1, not kelvins: EXR and PFM do");
  if (wrong == image.pixels.end()) {
    warn_of_celsius(context, hottest, label + ": " + file, place);
    return bitmap;
  }
  const auto pixel = static_cast<std::size_t>(wrong - image.pixels.begin());
  fail(place, label + " " + format_number(static_cast<double>(*wrong)) + " at pixel (" +
                  std::to_string(pixel % image.width) + ", " + std::to_string(pixel / image.width) + ") of " +
                  file + ": " + kTemperatureRule);
}

double read_constant_temperature(const ObjectReader& object) {
  const double temperature_k = object.require_float("temperature");
  object.check(is_temperature(temperature_k), "temperature", temperature_k, kTemperatureRule);
  return temperature_k;
}

void refuse_transform(const ObjectReader& object) {
  if (object.has("to_world")) object.fail_at("to_world", "a thermal emitter has no transform of its own");
}

std::string property_names(const Mesh& mesh) {
  std::string names;
  for (const auto& [name, values] : mesh.vertex_attributes)
    names += (names.empty() ? "'" : ", '") + name + "'";
  return names.empty() ? "it has none" : "it has " + names;
}

}  // namespace

ThermalEmitter read_thermal_emitter(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  refuse_transform(object);
  accept_sampling_weight(context, object);
  ThermalEmitter emitter;
  Node* temperature = object.find("temperature");
  if (object.has("temperature_attribute")) {
    if (temperature)
      object.fail_at("temperature_attribute", "'temperature_attribute' together with 'temperature'");
    emitter.attribute = object.require_string("temperature_attribute");
    if (emitter.attribute.empty())
      object.fail_at("temperature_attribute", "temperature_attribute: the name is empty");
  } else if (temperature && temperature->resolved().kind == TagKind::kObject) {
    emitter.texture = read_temperature_image(context, object, *temperature);
  } else {
    emitter.temperature_k = read_constant_temperature(object);
  }
  object.finish();
  return emitter;
}

double read_ambient_temperature(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  refuse_transform(object);
  accept_sampling_weight(context, object);
  Node* temperature = object.find("temperature");
  const bool image = temperature && temperature->resolved().kind == TagKind::kObject;
  if (image || object.has("temperature_attribute")) {
    object.fail_at(image ? "temperature" : "temperature_attribute", "the ambient temperature is one number");
  }
  const double temperature_k = read_constant_temperature(object);
  object.finish();
  return temperature_k;
}

void check_temperatures(ReadContext& context, const Shape& shape, const std::string& label,
                        const Place& place) {
  const std::string& name = shape.thermal->attribute;
  if (name.empty()) return;
  const auto* mesh = std::get_if<MeshShape>(&shape.geometry);
  if (!mesh)
    fail(place, label + ": temperature_attribute '" + name + "': only meshes have vertex properties");
  const auto found = mesh->mesh->vertex_attributes.find(name);
  if (found == mesh->mesh->vertex_attributes.end()) {
    fail(place, label + ": temperature_attribute: the mesh has no vertex property '" + name + "' (" +
                    property_names(*mesh->mesh) + ")");
  }
  const std::vector<float>& values = found->second;
  const auto wrong = std::find_if_not(values.begin(), values.end(), is_temperature);
  if (wrong == values.end()) {
    const float hottest = values.empty() ? 0 : *std::ranges::max_element(values);
    return warn_of_celsius(context, hottest, label + ": temperature_attribute: '" + name + "'", place);
  }
  fail(place, label + ": temperature_attribute: " + name + " " + format_number(static_cast<double>(*wrong)) +
                  " of vertex " + std::to_string(wrong - values.begin()) + ": " + kTemperatureRule);
}

}  // namespace kiloband
