#include "scene/read/object/object.hpp"

#include <algorithm>

#include "scene/read/object/refused_types.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

std::string article(std::string_view noun) {
  const bool vowel = std::string_view("aeiou").find(noun.substr(0, 1)) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(noun);
}

}  // namespace

Place place_of_value(const Node& node) {
  if (node.kind == TagKind::kRef) return node.id_place;
  if (node.kind == TagKind::kObject && node.type_place.line > 0) return node.type_place;
  for (const std::string_view name : {"value", "filename", "x", "y", "z"}) {
    if (const XmlAttribute* attribute = node.find(name)) return attribute->value_place;
  }
  return node.place;
}

std::string describe_kind(const Node& node) {
  if (node.kind == TagKind::kRef && node.target) return "a reference to " + describe_kind(*node.target);
  return article(node.tag);
}

ObjectReader::ObjectReader(Node& object) : object_(object) {
  for (const auto& child : object.children) {
    if (children_.try_emplace(child->name, child.get()).second) continue;
    fail(child->name_place, label() + ": parameter '" + child->name + "' is given twice");
  }
}

std::string ObjectReader::label() const {
  if (!object_.id.empty()) return object_.tag + " '" + object_.id + "'";
  return object_.type.empty() ? object_.tag : object_.type + " " + object_.tag;
}

Node* ObjectReader::find(std::string_view name) const {
  if (!object_.asked.contains(name)) object_.asked.emplace(name, object_.asked.size());
  const auto child = children_.find(name);
  if (child == children_.end()) return nullptr;
  child->second->used = true;
  return child->second;
}

std::vector<Node*> ObjectReader::nested(std::string_view tag) const {
  std::vector<Node*> found;
  for (const auto& child : object_.children) {
    Node& node = child->resolved();
    if (node.kind != TagKind::kObject || node.tag != tag) continue;
    child->used = node.used = node.used_as_part = true;
    found.push_back(&node);
  }
  return found;
}

Node* ObjectReader::nested_one(std::string_view tag) const {
  const std::vector<Node*> found = nested(tag);
  if (found.size() <= 1) return found.empty() ? nullptr : found[0];
  std::size_t count = 0;
  for (const auto& child : object_.children) {
    const Node& node = child->resolved();
    if (node.kind == TagKind::kObject && node.tag == tag && ++count == 2) {
      fail(child->place, label() + ": a second " + std::string(tag));
    }
  }
  throw std::logic_error("nested_one: the second object has gone");
}

const Node* ObjectReader::value_of(std::string_view name, std::string_view expected,
                                   std::initializer_list<std::string_view> tags) const {
  const Node* node = find(name);
  if (!node) return nullptr;
  if (std::find(tags.begin(), tags.end(), node->tag) != tags.end() && node->kind != TagKind::kObject)
    return node;
  fail_at(name, "parameter '" + std::string(name) + "': expected " + article(expected) + ", found " +
                    describe_kind(*node));
}

std::string ObjectReader::context(std::string_view name) const {
  return label() + ": " + std::string(name) + ": ";
}

double ObjectReader::get_float(std::string_view name, double fallback) const {
  const Node* node = value_of(name, "float", {"float", "integer"});
  if (!node) return fallback;
  const XmlAttribute& value = *node->find("value");
  if (node->tag == "integer")
    return static_cast<double>(parse_integer(value.value, value.value_place, context(name)));
  return parse_number(value.value, value.value_place, context(name));
}

double ObjectReader::require_float(std::string_view name) const {
  if (!has(name)) fail_here("parameter '" + std::string(name) + "' is missing");
  return get_float(name, 0);
}

int64_t ObjectReader::get_int(std::string_view name, int64_t fallback) const {
  const Node* node = value_of(name, "integer", {"integer"});
  return node ? parse_integer(node->find("value")->value, place_of_value(*node), context(name)) : fallback;
}

bool ObjectReader::get_bool(std::string_view name, bool fallback) const {
  const Node* node = value_of(name, "boolean", {"boolean"});
  return node ? parse_boolean(node->find("value")->value, place_of_value(*node), context(name)) : fallback;
}

std::string ObjectReader::get_string(std::string_view name, const std::string& fallback) const {
  const Node* node = value_of(name, "string", {"string"});
  return node ? node->find("value")->value : fallback;
}

std::string ObjectReader::require_string(std::string_view name) const {
  if (!has(name)) fail_here("parameter '" + std::string(name) + "' is missing");
  return get_string(name, {});
}

glm::dvec3 ObjectReader::get_vector(std::string_view name, const glm::dvec3& fallback) const {
  const Node* node = value_of(name, "point", {"point", "vector"});
  if (!node) return fallback;
  const XmlAttribute* value = node->find("value");
  glm::dvec3 result(0);
  if (!value) {
    for (int axis = 0; axis < 3; ++axis) {
      const XmlAttribute* component =
          node->find(std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1));
      if (!component)
        fail(node->place, context(name) + "<" + node->tag + "> needs 'value' or all of 'x', 'y' and 'z'");
      result[axis] = parse_number(component->value, component->value_place, context(name));
    }
    return result;
  }
  if (node->attributes.size() > 1)
    fail(node->place, context(name) + "<" + node->tag + "> has both 'value' and coordinates");
  return parse_triple(*value, context(name));
}

Transform ObjectReader::get_transform(std::string_view name) const {
  const Node* node = value_of(name, "transform", {"transform"});
  return node ? evaluate_transform(*node) : Transform(1.0);
}

glm::dmat3 ObjectReader::get_uv_transform(std::string_view name, const DiagnosticSink& sink) const {
  const Node* node = value_of(name, "transform", {"transform"});
  if (object_.legacy) {
    const glm::dvec2 scale(get_float("uscale", 1), get_float("vscale", 1));
    const glm::dvec2 offset(get_float("uoffset", 0), get_float("voffset", 0));
    for (const std::string_view part : {"uscale", "vscale", "uoffset", "voffset"})
      if (node && has(part)) fail_at(part, std::string(part) + " together with " + std::string(name));
    if (!node) return {{scale.x, 0, 0}, {0, scale.y, 0}, glm::dvec3(scale * offset, 1)};
  }
  return node ? evaluate_uv_transform(*node, sink) : glm::dmat3(1.0);
}

std::size_t ObjectReader::get_choice(std::string_view name,
                                     const std::vector<std::string_view>& choices) const {
  const std::string value = get_string(name, std::string(choices[0]));
  const auto found = std::find(choices.begin(), choices.end(), lowered(value));
  if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
  std::string known;
  for (const std::string_view choice : choices) known += (known.empty() ? "" : ", ") + std::string(choice);
  fail_at(name, std::string(name) + " '" + value + "': must be one of " + known);
}

Place ObjectReader::value_place(std::string_view name) const {
  const Node* node = find(name);
  return node ? place_of_value(*node) : object_.place;
}

void ObjectReader::check(bool ok, std::string_view name, double value, std::string_view rule) const {
  if (!ok) fail_at(name, std::string(name) + " " + format_number(value) + ": " + std::string(rule));
}

void ObjectReader::fail_at(std::string_view name, const std::string& message) const {
  fail(value_place(name), label() + ": " + message);
}

void ObjectReader::fail_here(const std::string& message) const {
  fail(object_.place, label() + ": " + message);
}

void ObjectReader::refuse_type(const std::vector<std::string_view>& known) const {
  const std::string_view why = why_refused(object_.tag, object_.type);
  fail(object_.type_place, object_.tag + " type '" + object_.type + "' is not supported" +
                               (why.empty() ? suggestion(object_.type, known) : ": " + std::string(why)));
}

void ObjectReader::finish() const {
  for (const auto& child : object_.children) {
    if (child->used) continue;
    if (!child->is_named())
      fail(child->place, label() + ": " + describe_kind(*child) + " is not allowed here");
    fail(child->name_place,
         label() + ": unknown parameter '" + child->name + "'" + suggestion(child->name, known_names()));
  }
}

std::vector<std::string_view> ObjectReader::known_names() const {
  std::vector<std::string_view> names(object_.asked.size());
  for (const auto& [name, order] : object_.asked) names[order] = name;
  return names;
}

}  // namespace kiloband
