// Groups of shapes and their instances. The meshes of a group are stored once, in coordinates about the middle of the
// group's box, so that their precision does not depend on where the group was modelled; an instance of them is a
// shape record for each, with KB_SHAPE_INSTANCED and both matrices. Spheres, disks and cylinders are a record each
// anyway: their instances are shapes like others. Instances in groups are multiplied out.
#include <fmt/format.h>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/compile/place.hpp"
#include "scene/compile/record_vectors.hpp"
#include "scene/compile/shapes.hpp"

namespace kiloband {
namespace {

/// Shapes that 32-bit places of words in the array of records reach, with a margin.
constexpr std::size_t kMostShapes = std::size_t{1} << 24;

bool is_mesh(const Shape& shape) {
  return std::holds_alternative<MeshShape>(shape.geometry);
}

}  // namespace

void ShapeCompiler::add_instances() {
  for (const Instance& instance : in_.instances)
    add_instance(instance, placed_at(out_.origin, instance.to_world));
}

const ShapeCompiler::FlatGroup& ShapeCompiler::flat_group(const ShapeGroup& group) {
  const auto [found, is_new] = flat_groups_.try_emplace(&group);
  FlatGroup& flat = found->second;
  if (!is_new) return flat;
  Extent extent;
  for (const Shape& shape : group.shapes)
    if (is_mesh(shape)) extend(shape, extent);
  if (extent.is_empty()) return flat;
  flat.middle = 0.5 * (extent.low + extent.high);
  const Transform to_middle = glm::translate(Transform{1.0}, -flat.middle);
  for (const Shape& shape : group.shapes) {
    if (!is_mesh(shape)) continue;
    KbShape record = begin_shape(shape, thermal_.heat_of(shape));
    record.flags |= KB_SHAPE_INSTANCED;
    add_mesh(record, shape, to_middle * shape.to_world);
    flat.meshes.push_back({&shape, record});
  }
  flat.index = static_cast<uint32_t>(out_.groups.size());
  out_.groups.push_back({KB_NONE, static_cast<uint32_t>(flat.meshes.size())});
  return flat;
}

void ShapeCompiler::add_instance(const Instance& instance, const Transform& to_world) {
  const ShapeGroup& group = *instance.group;
  const FlatGroup& flat = flat_group(group);
  if (out_.shapes.size() + group.shapes.size() > kMostShapes)
    throw InputError(instance.position,
                     fmt::format("more than {} shapes, counting those of instances", kMostShapes));
  if (!flat.meshes.empty()) {
    const auto first = static_cast<uint32_t>(out_.shapes.size());
    out_.instances.push_back({flat.index, first});
    if (out_.groups[flat.index].first_shape == KB_NONE) out_.groups[flat.index].first_shape = first;
    out_.features.instances = true;
  }
  const Transform matrix = glm::translate(to_world, flat.middle);
  const bool mirrored = glm::determinant(glm::dmat3(matrix)) < 0;
  for (const FlatMesh& mesh : flat.meshes) {
    KbShape record = mesh.record;
    set_transforms(record, matrix);
    if (mirrored)
      record.flags ^= KB_SHAPE_MIRRORED;  // what is outside of a group is outside of its mirror image
    add_record(record, *mesh.shape, instance.id);
  }
  for (const Shape& shape : group.shapes)
    if (!is_mesh(shape)) add_analytic(shape, thermal_.heat_of(shape), to_world * shape.to_world, instance.id);
  for (const Instance& nested : group.instances) add_instance(nested, to_world * nested.to_world);
}

}  // namespace kiloband
