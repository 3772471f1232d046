#include "scene/xml/grammar.hpp"

#include <algorithm>

#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

TagRule object_rule(std::string_view tag) {
  return {tag, TagKind::kObject, {"type"}, {"id", "name"}};
}
TagRule value_rule(std::string_view tag) {
  return {tag, TagKind::kValue, {"name", "value"}, {}};
}
TagRule vector_rule(std::string_view tag) {
  return {tag, TagKind::kValue, {"name"}, {"value", "x", "y", "z"}};
}

const std::vector<TagRule>& rules() {
  static const std::vector<TagRule> kRules = {
      {"scene", TagKind::kObject, {"version"}, {"type", "id", "name"}},
      object_rule("bsdf"),
      object_rule("emitter"),
      object_rule("film"),
      object_rule("integrator"),
      object_rule("medium"),
      object_rule("phase"),
      object_rule("rfilter"),
      object_rule("sampler"),
      object_rule("sensor"),
      object_rule("shape"),
      object_rule("texture"),
      object_rule("volume"),
      value_rule("integer"),
      value_rule("float"),
      value_rule("boolean"),
      value_rule("string"),
      value_rule("rgb"),
      vector_rule("point"),
      vector_rule("vector"),
      {"transform", TagKind::kTransform, {"name"}, {}},
      {"translate", TagKind::kStep, {}, {"value", "x", "y", "z"}},
      {"scale", TagKind::kStep, {}, {"value", "x", "y", "z"}},
      {"rotate", TagKind::kStep, {"angle"}, {"value", "x", "y", "z"}},
      {"matrix", TagKind::kStep, {"value"}, {}},
      {"lookat", TagKind::kStep, {"origin", "target"}, {"up"}},
      {"ref", TagKind::kRef, {"id"}, {"name"}},
      {"default", TagKind::kDirective, {"name", "value"}, {}},
      {"include", TagKind::kDirective, {"filename"}, {}},
      {"path", TagKind::kDirective, {"value"}, {}},
      {"alias", TagKind::kDirective, {"id", "as"}, {}},
  };
  return kRules;
}

/// <spectrum> is listed on its own because its attributes decide what it is.
const TagRule& spectrum_rule(const XmlElement& element) {
  static const TagRule kObject = object_rule("spectrum");
  static const TagRule kValue = {"spectrum", TagKind::kValue, {"name"}, {"value", "filename"}};
  if (element.find("type")) return kObject;
  if ((element.find("value") != nullptr) == (element.find("filename") != nullptr)) {
    fail(element.place, "<spectrum> needs exactly one of the attributes 'value', 'filename' and 'type'");
  }
  return kValue;
}

const TagRule& find_rule(const XmlElement& element) {
  if (element.tag == "spectrum") return spectrum_rule(element);
  for (const TagRule& rule : rules()) {
    if (rule.tag == element.tag) return rule;
  }
  std::vector<std::string_view> names = {"spectrum"};
  for (const TagRule& rule : rules()) names.push_back(rule.tag);
  fail(element.place, "unknown element <" + element.tag + ">" + suggestion(element.tag, names));
}

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}

}  // namespace

const TagRule& check_element(const XmlElement& element) {
  const TagRule& rule = find_rule(element);
  for (const XmlAttribute& attribute : element.attributes) {
    if (contains(rule.required, attribute.name) || contains(rule.optional, attribute.name)) continue;
    std::vector<std::string_view> known = rule.required;
    known.insert(known.end(), rule.optional.begin(), rule.optional.end());
    fail(attribute.place, "<" + element.tag + ">: unknown attribute '" + attribute.name + "'" +
                              suggestion(attribute.name, known));
  }
  for (const std::string_view name : rule.required) {
    if (!element.find(name))
      fail(element.place, "<" + element.tag + ">: attribute '" + std::string(name) + "' is missing");
  }
  return rule;
}

std::string snake_case(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool upper = is_upper(name[i]);
    if (upper && i > 0 && is_lower(name[i - 1])) result += '_';
    result += upper && i > 0 ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
  }
  return result;
}

}  // namespace kiloband
