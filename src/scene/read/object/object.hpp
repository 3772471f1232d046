// Typed access to the parameters of one object, with the checks that every object needs.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/description/description.hpp"
#include "scene/xml/tree.hpp"

namespace kiloband {

/// Asking for a parameter marks it as used and its name as known; finish() refuses what nobody asked for.
/// Getters return the fallback where the file has no such parameter and throw InputError, at the value, for a
/// parameter of another type. An <integer> is taken where a float is expected, never the reverse.
class ObjectReader {
 public:
  /// Checks that no parameter is given twice.
  explicit ObjectReader(Node& object);

  Node& node() const { return object_; }
  const std::string& type() const { return object_.type; }
  /// "bsdf 'leaf'" or, without an id, "diffuse bsdf".
  std::string label() const;

  /// The parameter as it stands in the file (possibly a reference), or null.
  Node* find(std::string_view name) const;
  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// Nothing of it was left out (ReadErrors); what is counted may be too few otherwise, which is no error of its own.
  bool is_whole() const { return object_.left_out.empty(); }
  /// Nested objects (references resolved) with this tag, in order; marks them as used.
  std::vector<Node*> nested(std::string_view tag) const;
  /// At most one such object; null if there is none.
  Node* nested_one(std::string_view tag) const;

  double get_float(std::string_view name, double fallback) const;
  double require_float(std::string_view name) const;
  int64_t get_int(std::string_view name, int64_t fallback) const;
  bool get_bool(std::string_view name, bool fallback) const;
  std::string get_string(std::string_view name, const std::string& fallback) const;
  std::string require_string(std::string_view name) const;
  glm::dvec3 get_vector(std::string_view name, const glm::dvec3& fallback) const;
  Transform get_transform(std::string_view name) const;  // identity by default
  /// Of texture coordinates; identity by default. In old files u' = uscale (u + uoffset) too, as Mitsuba 3
  /// reads them. `sink`: see evaluate_uv_transform().
  glm::dmat3 get_uv_transform(std::string_view name, const DiagnosticSink& sink) const;
  /// One of `choices` (compared without case); returns its index. The first is the default.
  std::size_t get_choice(std::string_view name, const std::vector<std::string_view>& choices) const;

  /// Where a parameter's value (or the object, if it has none) stands.
  Place value_place(std::string_view name) const;
  /// throws InputError  "label: name value: rule" at the value unless `ok`
  void check(bool ok, std::string_view name, double value, std::string_view rule) const;
  /// throws InputError  "label: message" at the parameter's value, or at the object
  [[noreturn]] void fail_at(std::string_view name, const std::string& message) const;
  [[noreturn]] void fail_here(const std::string& message) const;
  /// "label: x type 'foo' is not supported; did you mean ...?" at the type.
  [[noreturn]] void refuse_type(const std::vector<std::string_view>& known) const;

  /// Refuses what nobody asked for: unknown parameters (with the nearest known name), misplaced objects.
  void finish() const;

 private:
  const Node* value_of(std::string_view name, std::string_view expected,
                       std::initializer_list<std::string_view> tags) const;

  /// What the object's readers asked for, in that order; views of the node's own strings.
  std::vector<std::string_view> known_names() const;
  /// "label: name: ", which stands before what is wrong with a value.
  std::string context(std::string_view name) const;

  Node& object_;
  std::map<std::string_view, Node*> children_;  // by name; the tree owns names and nodes
};

/// v over its length, also where the squares of its coordinates leave double's range;
/// 0 for no or no finite length.
glm::dvec3 unit_vector(const glm::dvec3& v);

/// First byte of a value: its 'value' or 'filename' attribute, the id of a reference, the type of an object.
Place place_of_value(const Node& node);
/// "a float", "a string", "a bsdf" ...: what a node is, for messages.
std::string describe_kind(const Node& node);

/// A point or vector in one attribute: 3 numbers, or one for all of x, y and z, as Mitsuba reads them. `context` stands before messages.
glm::dvec3 parse_triple(const XmlAttribute& value, const std::string& context = {});

/// Transforms of a <transform>: identity, each step multiplied from the left.
/// throws InputError  singular, not affine, wrong number of values
Transform evaluate_transform(const Node& node);
/// The same for texture coordinates, as Mitsuba 3.9 applies it: the steps act on (u, v, 0, 1) and the first
/// two coordinates of the result count. A matrix of 9 numbers acts on (u, v, 1), which Mitsuba takes
/// otherwise: a note says so where it matters. A warning names matrices with entries for the coordinate
/// that textures lack.
glm::dmat3 evaluate_uv_transform(const Node& node, const DiagnosticSink& sink);

}  // namespace kiloband
