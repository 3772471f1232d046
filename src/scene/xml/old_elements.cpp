#include "scene/xml/old_elements.hpp"

#include <string>
#include <vector>

#include "scene/xml/values.hpp"
#include "spectral/colour/colour.hpp"

namespace kiloband {
namespace {

const XmlAttribute& required(const XmlElement& element, std::string_view name) {
  if (const XmlAttribute* attribute = element.find(name)) return *attribute;
  fail(element.place, "<" + element.tag + ">: attribute '" + std::string(name) + "' is missing");
}

XmlAttribute with_value(const XmlAttribute& attribute, std::string_view name, std::string value) {
  XmlAttribute result = attribute;
  result.name = name;
  result.value = std::move(value);
  return result;
}

/// "#rrggbb", or one or three numbers from 0 to 1.
std::vector<double> srgb_components(const XmlAttribute& value) {
  if (!value.value.starts_with("#")) return parse_numbers(value.value, value.value_place, "<srgb>: ");
  if (value.value.size() != 7 ||
      value.value.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    fail(value.value_place, "<srgb>: '" + value.value + "' is not a colour such as #8899aa");
  std::vector<double> components;
  for (std::size_t at = 1; at < 7; at += 2)
    components.push_back(std::stoi(value.value.substr(at, 2), nullptr, 16) / 255.0);
  return components;
}

XmlElement rgb_of(const XmlElement& element) {
  const XmlAttribute& value = required(element, "value");
  std::string text;
  for (const double component : srgb_components(value))
    text += (text.empty() ? "" : ", ") + format_number(srgb_decode(component));
  return {"rgb", element.place, {required(element, "name"), with_value(value, "value", text)}, {}};
}

/// It stands where the attribute does, so that messages tell it from the element.
XmlElement float_of(const XmlAttribute& attribute, std::string value) {
  return {"float",
          attribute.place,
          {with_value(attribute, "name", attribute.name), with_value(attribute, "value", std::move(value))},
          {}};
}

/// Mitsuba 0.x's has no ends either; "5000K" and "5000" are the same.
XmlElement planck_of(const XmlElement& element) {
  const XmlAttribute& temperature = required(element, "temperature");
  std::string kelvin = temperature.value;
  if (kelvin.ends_with("K") || kelvin.ends_with("k")) kelvin.pop_back();
  XmlElement result{"spectrum",
                    element.place,
                    {with_value(temperature, "type", "planck"), required(element, "name")},
                    {float_of(temperature, kelvin)}};
  if (const XmlAttribute* scale = element.find("scale"))
    result.children.push_back(float_of(*scale, scale->value));
  return result;
}

}  // namespace

std::optional<XmlElement> modern_form(const XmlElement& element) {
  if (element.tag == "srgb") return rgb_of(element);
  if (element.tag == "blackbody") return planck_of(element);
  return std::nullopt;
}

}  // namespace kiloband
