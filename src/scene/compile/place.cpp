// Scenes that stand far from their origin. Coordinates are floats: at 10^6 m they are 6 cm apart, too coarse
// for an aircraft in map coordinates. Everything is therefore moved, in double, so that the shapes are about
// the origin; what stands there already keeps its very coordinates.
#include "scene/compile/place.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "scene/read/object/limits.hpp"

namespace kiloband {
namespace {

/// Moved is what lies farther from the origin than this many times its own size: from there on coordinates
/// would lose more than five of their 24 bits.
constexpr double kFar = 32;

/// Beyond this single precision is no match for a scene whose other parts are metres: rays leave a surface by
/// 2^-19 of its coordinates, 2 cm at this distance.
constexpr double kFarApart = 1e4;            // m
constexpr double kOffset = 1.0 / (1 << 18);  // of a coordinate: off one surface and onto the next

/// An object with a name, at its place in the file.
struct Part {
  SourcePosition position;
  std::string name;
};

std::string named(const char* kind, const std::string& id) {
  return id.empty() ? kind : fmt::format("{} '{}'", kind, id);
}

[[noreturn]] void refuse(const Part& part, const std::string& what) {
  throw InputError(part.position, part.name + ": " + what);
}

/// Single precision takes the coordinates, and the squares of their differences.
void check_reach(const glm::dvec3& p, const Part& part) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(p[axis]) <= kMaxLength))
      refuse(part, fmt::format("{} = {:g} m: must be within {:g} m of the origin", "xyz"[axis], p[axis],
                               kMaxLength));
}

/// The same of sizes, which are divided by.
void check_size(double size, const Part& part) {
  if (!(size >= 1 / kMaxLength && size <= kMaxLength))
    refuse(part,
           fmt::format("a size of {:g} m: must be from {:g} to {:g} m", size, 1 / kMaxLength, kMaxLength));
}

void check_frame(const Transform& to_world, const Part& part) {
  check_reach(glm::dvec3(to_world[3]), part);
  for (int axis = 0; axis < 3; ++axis) check_size(glm::length(glm::dvec3(to_world[axis])), part);
}

/// Where a light without a surface stands; empty for those that are everywhere.
std::optional<glm::dvec3> place_of(const Emitter& emitter) {
  if (const auto* point = std::get_if<PointEmitter>(&emitter.model)) return point->position;
  if (const auto* spot = std::get_if<SpotEmitter>(&emitter.model)) return glm::dvec3(spot->to_world[3]);
  if (const auto* projector = std::get_if<ProjectorEmitter>(&emitter.model))
    return glm::dvec3(projector->to_world[3]);
  return std::nullopt;
}

void check_field(const std::shared_ptr<const Medium>& medium) {
  if (!medium) return;
  const Part part{medium->position, named("medium", medium->id)};
  if (const auto* grid = std::get_if<GridField>(&medium->field)) check_frame(grid->to_world, part);
  if (const auto* jet = std::get_if<JetField>(&medium->field)) {
    check_frame(jet->to_world, part);
    check_size(jet->radius, part);
  }
}

}  // namespace

void check_camera_place(const Sensor& sensor) {
  const Part camera{sensor.position, "sensor"};
  check_frame(sensor.to_world, camera);
}

void check_places(const SceneDescription& scene, GroupExtents& extents, const DiagnosticSink& sink) {
  Extent all;
  const auto add = [&](const glm::dvec3& p, const Part& part) {
    check_reach(p, part);
    all.add(p);
  };
  for (const Shape& shape : scene.shapes) {
    const Part part{shape.position, named("shape", shape.id)};
    Extent box;
    extend(shape, box);
    if (box.is_empty()) continue;
    add(box.low, part);
    add(box.high, part);
    if (!std::holds_alternative<MeshShape>(shape.geometry)) check_frame(shape.to_world, part);
    check_field(shape.interior);
  }
  for (const Instance& instance : scene.instances) {
    const Part part{instance.position, named("instance", instance.id)};
    check_frame(instance.to_world, part);
    Extent box;
    box.add_placed(extents.of(*instance.group), instance.to_world);
    add(box.low, part);
    add(box.high, part);
  }
  check_field(scene.atmosphere);
  for (const Emitter& emitter : scene.emitters)
    if (const auto place = place_of(emitter)) add(*place, {emitter.position, named("emitter", emitter.id)});
  check_camera_place(scene.sensor);
  all.add(glm::dvec3(scene.sensor.to_world[3]));
  const double side = all.largest_side();
  if (side <= kFarApart * (1 + 1e-6)) return;
  warn(sink, {scene.file.string(), 0, 0},
       fmt::format(
           "parts of the scene are {:.3g} m apart, more than {:g} m: single precision loses details smaller "
           "than {:.2g} m",
           side, kFarApart, side / 2 * kOffset));
}

std::array<double, 3> origin_of(const SceneDescription& scene, GroupExtents& extents) {
  Extent box;
  for (const Shape& shape : scene.shapes) extend(shape, box);
  for (const Instance& instance : scene.instances)
    box.add_placed(extents.of(*instance.group), instance.to_world);
  if (box.is_empty()) return {};
  const glm::dvec3 centre = 0.5 * (box.low + box.high);
  if (!(glm::length(centre) > kFar * 0.5 * glm::length(box.high - box.low))) return {};
  return {centre.x, centre.y, centre.z};
}

Transform placed_at(const std::array<double, 3>& origin, const Transform& to_world) {
  const auto& o = origin;
  if (o[0] == 0 && o[1] == 0 && o[2] == 0) return to_world;
  return glm::translate(Transform{1.0}, -glm::dvec3(o[0], o[1], o[2])) * to_world;
}

}  // namespace kiloband
