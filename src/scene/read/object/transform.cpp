// <transform>: steps to matrices. The first step acts first, so each one multiplies from the left.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "scene/read/object/object.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

constexpr double kSingular =
    1e-12;  // |det| over the product of the columns' lengths: nearly parallel columns

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

/// x, y, z of a step; `value` gives all three, or one number for all.
glm::dvec3 read_xyz(const XmlElement& step, double fallback) {
  glm::dvec3 result(fallback);
  if (const XmlAttribute* value = step.find("value")) {
    for (const std::string_view axis : {"x", "y", "z"}) {
      if (step.find(axis)) fail(step.place, "<" + step.tag + "> has both 'value' and coordinates");
    }
    return parse_triple(*value);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const XmlAttribute* component =
        step.find(std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1));
    if (component) result[axis] = parse_number(component->value, component->value_place);
  }
  return result;
}

glm::dvec3 read_triple(const XmlAttribute& attribute) {
  const std::vector<double> n = parse_numbers(attribute.value, attribute.value_place);
  if (n.size() != 3) fail(attribute.value_place, "expected 3 numbers, found " + std::to_string(n.size()));
  return {n[0], n[1], n[2]};
}

Transform rotation(const XmlElement& step) {
  const glm::dvec3 axis = read_xyz(step, 0);
  const XmlAttribute& angle = *step.find("angle");
  const double degrees = parse_number(angle.value, angle.value_place);
  const glm::dvec3 unit = unit_vector(axis);
  if (unit == glm::dvec3(0)) fail(step.place, "<rotate> needs an axis that is not zero");
  return glm::rotate(Transform(1.0), radians(degrees), unit);
}

/// 16 or 9 numbers, row by row.
Transform matrix(const XmlElement& step) {
  const XmlAttribute& value = *step.find("value");
  const std::vector<double> n = parse_numbers(value.value, value.value_place);
  if (n.size() != 16 && n.size() != 9) {
    fail(value.value_place, "<matrix> needs 16 or 9 numbers, found " + std::to_string(n.size()));
  }
  const int size = n.size() == 16 ? 4 : 3;
  Transform result(1.0);
  auto number = n.begin();
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) result[column][row] = *number++;
  }
  if (result[0][3] != 0 || result[1][3] != 0 || result[2][3] != 0 || result[3][3] != 1) {
    fail(value.value_place, "the last row of the matrix must be 0 0 0 1");
  }
  return result;
}

/// A vector perpendicular to unit d: d crossed with the axis that it is farthest from.
glm::dvec3 perpendicular(const glm::dvec3& d) {
  const glm::dvec3 a = glm::abs(d);
  const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                          : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                   : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(d, axis));
}

/// Local +Z looks from origin to target, +Y is as near to `up` as can be, +X is to the left.
Transform lookat(const XmlElement& step) {
  const glm::dvec3 origin = read_triple(*step.find("origin"));
  const glm::dvec3 to_target = read_triple(*step.find("target")) - origin;
  const glm::dvec3 direction = unit_vector(to_target);
  if (direction == glm::dvec3(0))
    fail(step.find("target")->value_place, "lookat: origin and target are equal");
  const XmlAttribute* up_attribute = step.find("up");
  glm::dvec3 up = up_attribute ? unit_vector(read_triple(*up_attribute)) : perpendicular(direction);
  if (up == glm::dvec3(0)) up = perpendicular(direction);
  const glm::dvec3 left = glm::cross(up, direction);
  if (!(glm::length(left) > 1e-9))
    fail(up_attribute->value_place, "lookat: up is parallel to the view direction");
  const glm::dvec3 unit_left = glm::normalize(left);
  return {glm::dvec4(unit_left, 0), glm::dvec4(glm::cross(direction, unit_left), 0), glm::dvec4(direction, 0),
          glm::dvec4(origin, 1)};
}

Transform step_matrix(const XmlElement& step) {
  const Transform identity(1.0);
  if (step.tag == "translate") return glm::translate(identity, read_xyz(step, 0));
  if (step.tag == "scale") return glm::scale(identity, read_xyz(step, 1));
  if (step.tag == "rotate") return rotation(step);
  if (step.tag == "matrix") return matrix(step);
  return lookat(step);
}

/// 9 numbers, row by row: a matrix of (u, v, 1). Mitsuba takes them for the part of a 4 x 4 matrix without
/// translation, so that its third column, which acts on a coordinate that textures lack, has no effect there.
Transform planar_matrix(const XmlElement& step, const std::vector<double>& n, const DiagnosticSink& sink) {
  const Place& place = step.find("value")->value_place;
  if (n[6] != 0 || n[7] != 0 || n[8] != 1) fail(place, "the last row of the matrix must be 0 0 1");
  if (n[2] != 0 || n[5] != 0)
    note(sink, place.position(),
         "a texture transform's <matrix> of 9 numbers: its third column is the translation, which Mitsuba 3 "
         "ignores (16 numbers mean the same to both)");
  return {glm::dvec4(n[0], n[3], 0, 0), glm::dvec4(n[1], n[4], 0, 0), glm::dvec4(0, 0, 1, 0),
          glm::dvec4(n[2], n[5], 0, 1)};
}

Transform uv_matrix(const XmlElement& step, const DiagnosticSink& sink) {
  const XmlAttribute& value = *step.find("value");
  const std::vector<double> n = parse_numbers(value.value, value.value_place);
  if (n.size() == 9) return planar_matrix(step, n, sink);
  const Transform result = matrix(step);
  const glm::dvec4 &u = result[0], &v = result[1], &w = result[2], &origin = result[3];
  if (w.x != 0 || w.y != 0 || u.z != 0 || v.z != 0 || origin.z != 0)
    warn(
        sink, value.value_place.position(),
        "a texture has no third coordinate: of the matrix only the first two rows count, without their third "
        "column (translations stand in the fourth)");
  return result;
}

/// One step on texture coordinates (u, v, 0, 1).
Transform uv_step_matrix(const XmlElement& step, const DiagnosticSink& sink) {
  if (step.tag == "matrix") return uv_matrix(step, sink);
  if (step.tag == "lookat") fail(step.place, "<lookat> is not allowed in a texture transform");
  const Transform full = step_matrix(step);
  if (full[0][2] != 0 || full[1][2] != 0 || full[2][0] != 0 || full[2][1] != 0 || full[3][2] != 0) {
    fail(step.place, "<" + step.tag + "> leaves the plane of the texture");
  }
  return full;
}

bool is_finite(const double* first, int count) {
  for (int i = 0; i < count; ++i) {
    if (!std::isfinite(first[i])) return false;
  }
  return true;
}

void check_regular(bool finite, double determinant, double scale, const Node& node) {
  const std::string name = "transform '" + node.name + "' ";
  if (!finite || !std::isfinite(determinant) || !std::isfinite(scale)) fail(node.place, name + "overflows");
  if (!(std::abs(determinant) > kSingular * scale)) fail(node.place, name + "is singular");
}

}  // namespace

glm::dvec3 parse_triple(const XmlAttribute& value, const std::string& context) {
  const std::vector<double> n = parse_numbers(value.value, value.value_place, context);
  if (n.size() == 1) return glm::dvec3(n[0]);
  if (n.size() == 3) return {n[0], n[1], n[2]};
  fail(value.value_place, context + "expected 1 or 3 numbers, found " + std::to_string(n.size()));
}

glm::dvec3 unit_vector(const glm::dvec3& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return glm::dvec3(0);
  return glm::normalize(v / largest);
}

Transform evaluate_transform(const Node& node) {
  Transform result(1.0);
  for (const XmlElement& step : node.steps) result = step_matrix(step) * result;
  const glm::dmat3 linear(result);
  const double scale = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  check_regular(is_finite(&result[0][0], 16), glm::determinant(linear), scale, node);
  return result;
}

glm::dmat3 evaluate_uv_transform(const Node& node, const DiagnosticSink& sink) {
  Transform full(1.0);
  for (const XmlElement& step : node.steps) full = uv_step_matrix(step, sink) * full;
  const glm::dmat3 result(glm::dvec3(full[0].x, full[0].y, 0), glm::dvec3(full[1].x, full[1].y, 0),
                          glm::dvec3(full[3].x, full[3].y, 1));
  const glm::dmat2 linear(result);
  check_regular(is_finite(&result[0][0], 9), glm::determinant(linear),
                glm::length(linear[0]) * glm::length(linear[1]), node);
  return result;
}

}  // namespace kiloband
