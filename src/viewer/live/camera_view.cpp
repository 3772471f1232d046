#include "viewer/live/camera_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.hpp"
#include "viewer/api/json_text.hpp"

namespace kiloband::viewer {
namespace {

using nlohmann::json;

constexpr double kDegrees = 180 / std::numbers::pi;

glm::dvec3 column(const Transform& m, int i) {
  return glm::dvec3(m[i]);
}

json triple(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

std::optional<glm::dvec3> vector_of(const json& wanted, const char* name) {
  const auto values = get_triple(wanted, name);
  if (!values) return std::nullopt;
  return glm::dvec3((*values)[0], (*values)[1], (*values)[2]);
}

double* fov_of(Sensor& sensor) {
  if (auto* perspective = std::get_if<PerspectiveSensor>(&sensor.model)) return &perspective->fov_x;
  if (auto* lens = std::get_if<ThinLensSensor>(&sensor.model)) return &lens->fov_x;
  return nullptr;
}

const char* type_of(const Sensor& sensor) {
  static constexpr const char* kNames[] = {"perspective", "thinlens", "orthographic"};
  return kNames[sensor.model.index()];
}

std::string float_xml(const char* name, double value) {
  return fmt::format("  <float name=\"{}\" value=\"{}\"/>\n", name, format_number(value));
}

std::string matrix_text(const Transform& m) {
  std::string text;
  for (int row = 0; row < 4; ++row)
    for (int c = 0; c < 4; ++c) text += (text.empty() ? "" : " ") + format_number(m[c][row]);
  return text;
}

}  // namespace

json camera_json(const Sensor& sensor, double distance, double scene_size) {
  const Transform& m = sensor.to_world;
  const glm::dvec3 origin = column(m, 3), forward = glm::normalize(column(m, 2));
  json camera{{"type", type_of(sensor)},
              {"origin", triple(origin)},
              {"target", triple(origin + distance * forward)},
              {"up", triple(glm::normalize(column(m, 1)))},
              {"scale_m", scene_size},
              {"pivot", triple(origin + distance * forward)}};
  Sensor copy = sensor;
  if (const double* fov = fov_of(copy)) camera["fov_deg"] = *fov * kDegrees;
  return camera;
}

Sensor placed_sensor(const Sensor& sensor, const json& wanted, double distance) {
  const Transform& m = sensor.to_world;
  const glm::dvec3 origin = vector_of(wanted, "origin").value_or(column(m, 3));
  const glm::dvec3 target =
      vector_of(wanted, "target").value_or(column(m, 3) + distance * glm::normalize(column(m, 2)));
  const glm::dvec3 up = vector_of(wanted, "up").value_or(glm::normalize(column(m, 1)));
  const glm::dvec3 forward = glm::normalize(target - origin);
  if (!(glm::length(target - origin) > 0) || !std::isfinite(glm::length(forward)))
    throw InputError("camera: origin and target must differ");
  glm::dvec3 left = glm::cross(up, forward);
  if (!(glm::length(left) > 1e-9 * glm::length(up)) || !std::isfinite(glm::length(left)))
    throw InputError("camera: up must not be along the view");
  left = glm::normalize(left);
  const glm::dvec3 above = glm::cross(forward, left);
  if (glm::determinant(glm::dmat3(m)) < 0) left = -left;
  Sensor placed = sensor;
  placed.to_world = {glm::dvec4(left * glm::length(column(m, 0)), 0),
                     glm::dvec4(above * glm::length(column(m, 1)), 0),
                     glm::dvec4(forward * glm::length(column(m, 2)), 0), glm::dvec4(origin, 1)};
  const auto fov = get_number(wanted, "fov_deg");
  if (fov && (*fov < 0.01 || *fov > 175)) throw InputError("fov_deg: must be from 0.01 to 175");
  if (fov) {
    double* const angle = fov_of(placed);
    if (!angle) throw InputError("fov_deg: an orthographic camera has no angle of view");
    *angle = *fov / kDegrees;
  }
  return placed;
}

std::string sensor_xml(const Sensor& sensor) {
  std::string xml = fmt::format("<sensor type=\"{}\">\n", type_of(sensor));
  Sensor copy = sensor;
  if (const double* fov = fov_of(copy))
    xml += float_xml("fov", *fov * kDegrees) + "  <string name=\"fov_axis\" value=\"x\"/>\n";
  if (const auto* lens = std::get_if<ThinLensSensor>(&sensor.model))
    xml += float_xml("aperture_radius", lens->aperture_radius) +
           float_xml("focus_distance", lens->focus_distance);
  xml += float_xml("near_clip", sensor.near_clip) + float_xml("far_clip", sensor.far_clip);
  if (sensor.principal_point_x != 0) xml += float_xml("principal_point_offset_x", sensor.principal_point_x);
  if (sensor.principal_point_y != 0) xml += float_xml("principal_point_offset_y", sensor.principal_point_y);
  return xml + fmt::format(
                   "  <transform name=\"to_world\">\n    <matrix value=\"{}\"/>\n  </transform>\n</sensor>\n",
                   matrix_text(sensor.to_world));
}

Sensor reduced_sensor(const Sensor& sensor, uint32_t factor) {
  Sensor reduced = sensor;
  Film& film = reduced.film;
  const auto shrink = [factor](uint32_t& size) { size = std::max(1u, (size + factor - 1) / factor); };
  film.crop_x /= factor;
  film.crop_y /= factor;
  for (uint32_t* size : {&film.width, &film.height, &film.crop_width, &film.crop_height}) shrink(*size);
  film.crop_width = std::min(film.crop_width, film.width - film.crop_x);
  film.crop_height = std::min(film.crop_height, film.height - film.crop_y);
  return reduced;
}

}  // namespace kiloband::viewer
