// Scenes that stand far from their origin. Coordinates are floats: at 10^6 m they are 6 cm apart, too coarse
// for an aircraft in map coordinates. Everything is therefore moved, in double, so that the shapes are about
// the origin; what stands there already keeps its very coordinates.
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "scene/flattener.hpp"

namespace kiloband {
namespace {

/// Moved is what lies farther from the origin than this many times its own size: from there on coordinates
/// would lose more than five of their 24 bits.
constexpr double kFar = 32;

/// World-space box of a shape's points, or of a box around a canonical analytic shape.
void extend(const Shape& shape, glm::dvec3& low, glm::dvec3& high) {
  const auto add = [&](const glm::dvec3& p) {
    const glm::dvec3 world(shape.to_world * glm::dvec4(p, 1));
    low = glm::min(low, world);
    high = glm::max(high, world);
  };
  if (const auto* mesh = std::get_if<MeshShape>(&shape.geometry)) {
    for (const Vec3f& p : mesh->mesh->positions) add({p[0], p[1], p[2]});
    return;
  }
  for (int corner = 0; corner < 8; ++corner)
    add({corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1});
}

}  // namespace

void Flattener::set_origin() {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const Shape& shape : in_.shapes) extend(shape, low, high);
  if (!(low.x <= high.x)) return;
  const glm::dvec3 centre = 0.5 * (low + high);
  if (!(glm::length(centre) > kFar * 0.5 * glm::length(high - low))) return;
  for (int axis = 0; axis < 3; ++axis) out_.origin[axis] = centre[axis];
}

/// The transform to the coordinates of FlatScene.
Transform Flattener::placed(const Transform& to_world) const {
  const auto& o = out_.origin;
  if (o[0] == 0 && o[1] == 0 && o[2] == 0) return to_world;
  return glm::translate(Transform{1.0}, -glm::dvec3(o[0], o[1], o[2])) * to_world;
}

}  // namespace kiloband
