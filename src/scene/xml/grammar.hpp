// Which elements a scene file may contain and which attributes each may carry.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/xml/document.hpp"

namespace kiloband {

enum class TagKind {
  kObject,     // bsdf, shape, ...: has a type and nested elements
  kValue,      // float, rgb, ...: a named parameter without nested elements
  kTransform,  // a named parameter made of steps
  kStep,       // translate, scale, ...: inside a transform
  kRef,
  kDirective  // default, include, path, alias
};

struct TagRule {
  std::string_view tag;
  TagKind kind;
  std::vector<std::string_view> required;
  std::vector<std::string_view> optional;
};

/// The rule of an element; `<spectrum type=...>` is an object, `<spectrum value=...>` a value.
/// throws InputError  unknown element; attribute that is unknown or missing
const TagRule& check_element(const XmlElement& element);

/// snake_case of an old file's camelCase parameter name: "toWorld" to "to_world", "intIOR" to "int_ior".
std::string snake_case(std::string_view name);

}  // namespace kiloband
