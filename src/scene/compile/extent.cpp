#include "scene/compile/extent.hpp"

namespace kiloband {

void Extent::add_placed(const Extent& other, const Transform& transform) {
  if (other.is_empty()) return;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? other.high.x : other.low.x, corner & 2 ? other.high.y : other.low.y,
                       corner & 4 ? other.high.z : other.low.z);
    add(glm::dvec3(transform * glm::dvec4(p, 1)));
  }
}

void extend(const Shape& shape, Extent& extent) {
  const auto add = [&](const glm::dvec3& p) { extent.add(glm::dvec3(shape.to_world * glm::dvec4(p, 1))); };
  if (const auto* mesh = std::get_if<MeshShape>(&shape.geometry)) {
    for (const Vec3f& p : mesh->mesh->positions) add({p[0], p[1], p[2]});
    return;
  }
  const bool sphere = std::holds_alternative<SphereShape>(shape.geometry);
  const double low = sphere ? -1 : 0, high = std::holds_alternative<DiskShape>(shape.geometry) ? 0 : 1;
  for (int corner = 0; corner < 8; ++corner)
    add({corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? high : low});
}

const Extent& GroupExtents::of(const ShapeGroup& group) {
  const auto found = extents_.find(&group);
  if (found != extents_.end()) return found->second;
  Extent extent;
  for (const Shape& shape : group.shapes) extend(shape, extent);
  for (const Instance& instance : group.instances) extent.add_placed(of(*instance.group), instance.to_world);
  return extents_[&group] = extent;
}

}  // namespace kiloband
