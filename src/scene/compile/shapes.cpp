#include "scene/compile/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "scene/compile/light/lattice_cdf.hpp"
#include "scene/compile/place.hpp"
#include "scene/compile/record_vectors.hpp"
#include "scene/compile/shape_bounds.hpp"

namespace kiloband {
namespace {

KbFloat3 to_record(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

bool mirrors(const Transform& to_world) {
  return glm::determinant(glm::dmat3(to_world)) < 0;
}

/// Vertex normals in the world. Normals of the file are mapped;
/// computed ones are those of the placed triangles.
std::vector<KbFloat3> placed_normals(const Mesh& mesh, const Transform& to_world) {
  const glm::dmat3 linear(to_world);
  std::vector<KbFloat3> placed;
  if (!mesh.front_by_normals && linear != glm::dmat3(1.0)) {
    LinearMap map;
    for (int column = 0; column < 3; ++column)
      for (int axis = 0; axis < 3; ++axis) map[column][axis] = linear[column][axis];
    for (const Vec3f& n : mapped_vertex_normals(mesh, map)) placed.push_back({n[0], n[1], n[2]});
    return placed;
  }
  const glm::dmat3 normal_to_world = glm::transpose(glm::inverse(linear));
  for (const Vec3f& n : mesh.normals) {
    const glm::dvec3 world = normal_to_world * glm::dvec3(n[0], n[1], n[2]);
    const double length = glm::length(world);
    placed.push_back(to_record(length > 0 ? world / length : glm::dvec3(0)));
  }
  return placed;
}

/// World-space corners that enclose an analytic shape.
void extend_bounds(const KbShape& shape, glm::dvec3& low, glm::dvec3& high) {
  const float* m = shape.to_world;
  const double z_low = shape.type == KB_SHAPE_SPHERE ? -1 : 0;
  const double z_high = shape.type == KB_SHAPE_DISK ? 0 : 1;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p((corner & 1) ? 1 : -1, (corner & 2) ? 1 : -1, (corner & 4) ? z_high : z_low);
    glm::dvec3 world;
    for (int row = 0; row < 3; ++row) {
      world[row] = m[4 * row] * p.x + m[4 * row + 1] * p.y + m[4 * row + 2] * p.z + m[4 * row + 3];
    }
    low = glm::min(low, world);
    high = glm::max(high, world);
  }
}

}  // namespace

ShapeCompiler::ShapeCompiler(const CompileContext& context, SurfaceCompiler& surfaces,
                             ThermalCompiler& thermal, EmitterCompiler& emitters)
    : in_(context.in),
      out_(context.out),
      current_(context.mesh),
      extents_(context.extents),
      surfaces_(surfaces),
      thermal_(thermal),
      emitters_(emitters) {}

void ShapeCompiler::add_shapes() {
  for (const Shape& shape : in_.shapes) {
    const uint32_t heat = thermal_.heat_of(shape);
    if (std::holds_alternative<MeshShape>(shape.geometry)) {
      KbShape record = begin_shape(shape, heat);
      const Transform to_world = placed_at(out_.origin, shape.to_world);
      set_transforms(record, to_world);
      add_mesh(record, shape, to_world);
      add_record(record, shape, {});
    } else {
      add_analytic(shape, heat, placed_at(out_.origin, shape.to_world), {});
    }
    if (shape.emitter) emitters_.add_area_emitter(shape);
    if (shape.thermal) emitters_.add_thermal_emitter(thermal_.heats()[heat]);
  }
  plain_positions_ = out_.positions.size();
}

/// What does not depend on the geometry.
KbShape ShapeCompiler::begin_shape(const Shape& shape, uint32_t heat) {
  const auto* mesh = std::get_if<MeshShape>(&shape.geometry);
  current_.mesh = mesh ? mesh->mesh.get() : nullptr;
  KbShape record{};
  record.surface = surfaces_.surface(shape.bsdf, heat);
  record.emitter = record.first_cdf = KB_NONE;
  record.flags = shape.flip_normals ? KB_SHAPE_FLIP_NORMALS : 0;
  if (out_.surfaces[record.surface].flags & KB_SURFACE_NULL) record.flags |= KB_SHAPE_NULL;
  return record;
}

/// instance: its id, or empty
void ShapeCompiler::add_record(const KbShape& record, const Shape& shape, const std::string& instance) {
  const std::string name =
      shape.id.empty() || instance.empty() ? instance + shape.id : instance + "/" + shape.id;
  out_.shape_names.push_back(name.empty() ? fmt::format("shape {}", out_.shapes.size()) : name);
  out_.shapes.push_back(record);
  sources_.push_back(&shape);
}

/// to_world: of the scene; the shape's own says whether it is mirrored
void ShapeCompiler::add_analytic(const Shape& shape, uint32_t heat, const Transform& to_world,
                                 const std::string& instance) {
  KbShape record = begin_shape(shape, heat);
  set_transforms(record, to_world);
  record.type = std::holds_alternative<SphereShape>(shape.geometry) ? KB_SHAPE_SPHERE
                : std::holds_alternative<DiskShape>(shape.geometry) ? KB_SHAPE_DISK
                                                                    : KB_SHAPE_CYLINDER;
  record.area = static_cast<float>(analytic_area(record.type, to_world));
  // A mirrored sphere shows its inside, as in Mitsuba, where disks and cylinders do not turn over.
  if (record.type == KB_SHAPE_SPHERE && mirrors(shape.to_world)) record.flags ^= KB_SHAPE_FLIP_NORMALS;
  out_.features.analytic_shapes = true;
  add_record(record, shape, instance);
}

/// to_world: to the coordinates of FlatScene::positions
void ShapeCompiler::add_mesh(KbShape& record, const Shape& shape, const Transform& to_world) {
  const Mesh& mesh = *std::get<MeshShape>(shape.geometry).mesh;
  record.type = KB_SHAPE_MESH;
  const std::size_t first = out_.positions.size();
  if (first + mesh.positions.size() > 0xffffffffu ||
      out_.triangles.size() / 3 + mesh.triangles.size() > 0x7fffffffu) {
    throw InputError(shape.position, "the scene has more vertices or triangles than 32-bit indices can name");
  }
  record.first_triangle = static_cast<uint32_t>(out_.triangles.size() / 3);
  record.triangle_count = static_cast<uint32_t>(mesh.triangles.size());
  for (const Vec3f& p : mesh.positions) {
    out_.positions.push_back(to_record(glm::dvec3(to_world * glm::dvec4(p[0], p[1], p[2], 1))));
  }
  if (!mesh.normals.empty()) {
    record.flags |= KB_SHAPE_HAS_NORMALS;
    out_.normals.resize(first, KbFloat3{0, 0, 0});
    const std::vector<KbFloat3> normals = placed_normals(mesh, to_world);
    out_.normals.insert(out_.normals.end(), normals.begin(), normals.end());
  }
  if (!mesh.uvs.empty()) {
    record.flags |= KB_SHAPE_HAS_UVS;
    out_.uvs.resize(first, KbFloat2{0, 0});
    for (const Vec2f& uv : mesh.uvs) out_.uvs.push_back({uv[0], uv[1]});
  }
  // A mirroring transform turns the winding; corners keep their order, which barycentric uv follow.
  if (mesh.front_by_normals && mirrors(to_world)) record.flags |= KB_SHAPE_MIRRORED;
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) out_.triangles.push_back(static_cast<uint32_t>(first) + corner);
  if (!out_.normals.empty()) out_.normals.resize(out_.positions.size(), KbFloat3{0, 0, 0});
  if (!out_.uvs.empty()) out_.uvs.resize(out_.positions.size(), KbFloat2{0, 0});
  add_areas(record, shape);
}

/// The record's area; an area light also gets the table that its triangles are chosen by.
void ShapeCompiler::add_areas(KbShape& record, const Shape& shape) {
  std::vector<double> areas(record.triangle_count);
  double total = 0;
  for (uint32_t i = 0; i < record.triangle_count; ++i) {
    const uint32_t* index = &out_.triangles[3 * (std::size_t{record.first_triangle} + i)];
    const glm::dvec3 p0 = to_glm(out_.positions[index[0]]);
    const glm::dvec3 e1 = to_glm(out_.positions[index[1]]) - p0;
    const glm::dvec3 e2 = to_glm(out_.positions[index[2]]) - p0;
    areas[i] = 0.5 * glm::length(glm::cross(e1, e2));
    total += areas[i];
  }
  record.area = static_cast<float>(total);
  record.first_cdf = KB_NONE;
  if (!shape.emitter && !shape.thermal) return;
  if (!std::isfinite(total)) throw InputError(shape.position, "area light: its area in m^2 must be finite");
  check_lattice_items(areas.size(), shape.position, "triangles of an area light");
  record.first_cdf = static_cast<uint32_t>(out_.area_cdf.size());
  const std::vector<float> cdf = lattice_cdf(areas);
  out_.area_cdf.insert(out_.area_cdf.end(), cdf.begin(), cdf.end());
}

void ShapeCompiler::set_radius() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  glm::dvec3 low(kInfinity), high(-kInfinity);
  for (const KbFloat3& p : std::span(out_.positions).first(plain_positions_)) {
    low = glm::min(low, to_glm(p));
    high = glm::max(high, to_glm(p));
  }
  for (const KbShape& shape : out_.shapes) {
    if (shape.type != KB_SHAPE_MESH) extend_bounds(shape, low, high);
  }
  Extent instances;
  for (const Instance& instance : in_.instances)
    instances.add_placed(extents_.of(*instance.group), placed_at(out_.origin, instance.to_world));
  low = glm::min(low, instances.low);
  high = glm::max(high, instances.high);
  if (!(low.x <= high.x)) return;  // no geometry: radius 0
  out_.scene_radius = static_cast<float>(0.5 * glm::length(high - low));
}

}  // namespace kiloband
