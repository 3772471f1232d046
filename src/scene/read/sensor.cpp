// <sensor type="perspective | thinlens | orthographic">
#include <cmath>
#include <numbers>

#include "scene/read/context.hpp"
#include "scene/read/object/limits.hpp"
#include "scene/xml/values.hpp"

namespace kiloband {
namespace {

constexpr double kMinFocus = 1e-6;     // m
constexpr double kNearOfMeter = 1e-9;  // m
constexpr double kMaxOffset = 1000;

enum class FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };

/// Half the tangent's angle along x for a full angle along `axis`; aspect = width / height of the full film.
double fov_x(double fov, FovAxis axis, double aspect) {
  const double t = std::tan(fov / 2);
  switch (axis) {
    case FovAxis::kX:
      return fov;
    case FovAxis::kY:
      return 2 * std::atan(t * aspect);
    case FovAxis::kDiagonal:
      return 2 * std::atan(t / std::sqrt(1 + 1 / (aspect * aspect)));
    case FovAxis::kSmaller:
      return fov_x(fov, aspect > 1 ? FovAxis::kY : FovAxis::kX, aspect);
    case FovAxis::kLarger:
      return fov_x(fov, aspect > 1 ? FovAxis::kX : FovAxis::kY, aspect);
  }
  throw std::logic_error("fov_x: unknown axis");
}

/// "50mm": focal length for the 36 mm x 24 mm format, whose diagonal gives the angle.
double diagonal_fov(const ObjectReader& object) {
  std::string text = object.get_string("focal_length", "50mm");
  if (!text.ends_with("mm"))
    object.fail_at("focal_length", "focal_length '" + text + "': must be a length such as 50mm");
  text.resize(text.size() - 2);
  const double f_mm =
      parse_number(text, object.value_place("focal_length"), object.label() + ": focal_length: ");
  object.check(f_mm > 0, "focal_length", f_mm, "must be > 0 mm");
  return 2 * std::atan(std::hypot(36.0, 24.0) / (2 * f_mm));
}

}  // namespace

double read_fov(const ObjectReader& object, double aspect) {
  const auto axis =
      static_cast<FovAxis>(object.get_choice("fov_axis", {"x", "y", "diagonal", "smaller", "larger"}));
  if (!object.has("fov")) return fov_x(diagonal_fov(object), FovAxis::kDiagonal, aspect);
  if (object.has("focal_length")) object.fail_at("focal_length", "'focal_length' together with 'fov'");
  const double degrees = object.require_float("fov");
  object.check(degrees > 0 && degrees < 180, "fov", degrees, "must be between 0 and 180 degrees");
  return fov_x(degrees * std::numbers::pi / 180, axis, aspect);
}

namespace {

ThinLensSensor read_lens(const ObjectReader& object, const Sensor& sensor, double fov) {
  ThinLensSensor lens;
  lens.fov_x = fov;
  lens.aperture_radius = object.require_float("aperture_radius");
  object.check(lens.aperture_radius > 0, "aperture_radius", lens.aperture_radius, "must be > 0");
  check_at_most(object, "aperture_radius", lens.aperture_radius, kMaxLength, "m");
  lens.focus_distance = object.get_float("focus_distance", sensor.far_clip);
  object.check(lens.focus_distance > 0, "focus_distance", lens.focus_distance, "must be > 0");
  object.check(lens.focus_distance >= kMinFocus && lens.focus_distance <= kMaxLength, "focus_distance",
               lens.focus_distance, "must be from 1e-06 to 1e+09 m");
  return lens;
}

/// What all three kinds have.
void read_common(ReadContext& context, const ObjectReader& object, Sensor& sensor, double near_clip = 0.01) {
  sensor.position = object.node().place.position();
  sensor.to_world = object.get_transform("to_world");
  sensor.near_clip = object.get_float("near_clip", near_clip);
  sensor.far_clip = object.get_float("far_clip", 1e4);
  object.check(sensor.near_clip > 0, "near_clip", sensor.near_clip, "must be > 0");
  check_at_most(object, "near_clip", sensor.near_clip, kMaxLength, "m");
  object.check(sensor.far_clip > sensor.near_clip, "far_clip", sensor.far_clip,
               "must be larger than near_clip");
  const double open = object.get_float("shutter_open", 0);  // nothing moves: the times have no effect
  const double close = object.get_float("shutter_close", 0);
  object.check(close >= open, "shutter_close", close, "must not be before shutter_open");
  if (object.has("srf"))
    object.fail_at("srf",
                   "srf: channels have no response here: name it in a specfilm, or give it to --response");
  Node* film = object.nested_one("film");
  sensor.film = film ? read_film(context, *film) : default_film(context);
  if (Node* sampler = object.nested_one("sampler")) sensor.sample_count = read_sampler(context, *sampler);
}

/// Unit, perpendicular axes within 1e-3, as Mitsuba demands of cameras with an angle of view;
/// mirroring is allowed.
void check_rigid(const ObjectReader& object, const Transform& to_world) {
  const glm::dmat3 m(to_world);
  for (int axis = 0; axis < 3; ++axis) {
    const double length = glm::length(m[axis]);
    if (std::abs(length - 1) > 1e-3) {
      object.fail_at("to_world",
                     "to_world scales by " + format_number(length) + ": a camera's transform must not scale");
    }
  }
  if (!is_similarity(m))
    object.fail_at("to_world", "to_world shears: a camera's transform must only rotate and move");
}

/// One ray: a camera whose film of one pixel has no extent.
Sensor read_radiance_meter(ReadContext& context, const ObjectReader& object) {
  Sensor sensor;
  read_common(context, object, sensor, kNearOfMeter);
  if (object.has("origin") || object.has("direction")) {
    if (object.has("to_world"))
      object.fail_at("to_world", "'to_world' together with 'origin' or 'direction'");
    const glm::dvec3 origin = object.get_vector("origin", {0, 0, 0});
    const glm::dvec3 z = unit_vector(object.get_vector("direction", {0, 0, 1}));
    if (z == glm::dvec3(0)) object.fail_at("direction", "direction: its length must be > 0");
    const glm::dvec3 helper = std::abs(z.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
    sensor.to_world = {glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0),
                       glm::dvec4(origin, 1)};
  }
  check_rigid(object, sensor.to_world);
  if (sensor.film.width != 1 || sensor.film.height != 1)
    object.fail_here("its film must be of one pixel, found " + std::to_string(sensor.film.width) + " x " +
                     std::to_string(sensor.film.height));
  sensor.model = PerspectiveSensor{0};
  object.finish();
  return sensor;
}

}  // namespace

Sensor read_sensor(ReadContext& context, Node& node) {
  const ObjectReader object(node);
  if (node.type == "radiancemeter") return read_radiance_meter(context, object);
  const bool thin_lens = node.type == "thinlens", orthographic = node.type == "orthographic";
  if (!thin_lens && !orthographic && node.type != "perspective") {
    object.refuse_type({"perspective", "thinlens", "orthographic", "radiancemeter"});
  }
  Sensor sensor;
  read_common(context, object, sensor);
  if (orthographic) {
    sensor.model = OrthographicSensor{};
  } else {
    check_rigid(object, sensor.to_world);
    sensor.principal_point_x = object.get_float("principal_point_offset_x", 0);
    sensor.principal_point_y = object.get_float("principal_point_offset_y", 0);
    check_at_most(object, "principal_point_offset_x", sensor.principal_point_x, kMaxOffset,
                  "widths of the film");
    check_at_most(object, "principal_point_offset_y", sensor.principal_point_y, kMaxOffset,
                  "heights of the film");
    const double fov = read_fov(object, static_cast<double>(sensor.film.width) / sensor.film.height);
    if (thin_lens) {
      sensor.model = read_lens(object, sensor, fov);
    } else {
      sensor.model = PerspectiveSensor{fov};
    }
  }
  if (!thin_lens)
    object.get_float("focus_distance", sensor.far_clip);  // accepted as in Mitsuba: everything is in focus
  object.finish();
  return sensor;
}

}  // namespace kiloband
