#include "src_cpu/geometry/embree_build.hpp"

#include <fmt/format.h>

#include <limits>
#include <tuple>
#include <vector>

#include "base/error.hpp"
#include "base/foreign_order.hpp"
#include "scene/compile/shape_bounds.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"

namespace kiloband::cpu {
namespace {

const AnalyticShapes& shapes_of(void* geometry) {
  return *static_cast<const AnalyticShapes*>(geometry);
}

/// The callbacks run on threads of TBB's, after what the scene is built from has been written.
char build_order;

void analytic_bounds(const RTCBoundsFunctionArguments* args) {
  const ForeignOrder order(build_order);
  const KbShape& shape = shapes_of(args->geometryUserPtr).shape(args->primID);
  std::tie(args->bounds_o->lower_x, args->bounds_o->upper_x) = analytic_interval(shape, 0);
  std::tie(args->bounds_o->lower_y, args->bounds_o->upper_y) = analytic_interval(shape, 1);
  std::tie(args->bounds_o->lower_z, args->bounds_o->upper_z) = analytic_interval(shape, 2);
}

bool hit_form(const ShapeForm& form, RTCRayN* rays, unsigned count, unsigned lane, double& t) {
  const glm::dvec3 origin(RTCRayN_org_x(rays, count, lane), RTCRayN_org_y(rays, count, lane),
                          RTCRayN_org_z(rays, count, lane));
  const glm::dvec3 direction(RTCRayN_dir_x(rays, count, lane), RTCRayN_dir_y(rays, count, lane),
                             RTCRayN_dir_z(rays, count, lane));
  return intersect_form(form, origin, direction, RTCRayN_tnear(rays, count, lane),
                        RTCRayN_tfar(rays, count, lane), t);
}

/// The hit's id is the shape's.
void analytic_intersect(const RTCIntersectFunctionNArguments* args) {
  const AnalyticShapes& shapes = shapes_of(args->geometryUserPtr);
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    double t = 0;
    if (args->valid[lane] != -1 || !hit_form(shapes.forms[args->primID], rays, args->N, lane, t)) continue;
    RTCRayN_tfar(rays, args->N, lane) = static_cast<float>(t);
    RTCHitN_geomID(hits, args->N, lane) = shapes.ids[args->primID];
    RTCHitN_primID(hits, args->N, lane) = 0;
    RTCHitN_instID(hits, args->N, lane, 0) = RTC_INVALID_GEOMETRY_ID;
    RTCHitN_u(hits, args->N, lane) = 0;
    RTCHitN_v(hits, args->N, lane) = 0;
  }
}

/// The ray of an occlusion query meets a null boundary.
void note_boundary(RTCIntersectContext* context, RTCRayN* rays, unsigned count, unsigned lane) {
  uint32_t* const passes = reinterpret_cast<OcclusionContext*>(context)->passes;
  if (passes) passes[RTCRayN_id(rays, count, lane)] = 1;
}

void analytic_occluded(const RTCOccludedFunctionNArguments* args) {
  const AnalyticShapes& shapes = shapes_of(args->geometryUserPtr);
  const bool boundary = shapes.shape(args->primID).flags & KB_SHAPE_NULL;
  for (unsigned lane = 0; lane < args->N; ++lane) {
    double t = 0;
    if (args->valid[lane] != -1 || !hit_form(shapes.forms[args->primID], args->ray, args->N, lane, t))
      continue;
    if (boundary)
      note_boundary(args->context, args->ray, args->N, lane);
    else
      RTCRayN_tfar(args->ray, args->N, lane) = -std::numeric_limits<float>::infinity();
  }
}

/// Of a mesh that is a null boundary: what it hides is nothing.
void pass_boundary(const RTCFilterFunctionNArguments* args) {
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] != -1) continue;
    note_boundary(args->context, args->ray, args->N, lane);
    args->valid[lane] = 0;
  }
}

[[noreturn]] void fail(RTCDevice device, const char* what) {
  const RTCError code = rtcGetDeviceError(device);
  throw DeviceError(fmt::format("Embree: {} failed (error {})", what, static_cast<int>(code)));
}

struct SceneBuilder {
  RTCDevice device;
  RTCScene scene;
  const FlatScene& flat;

  void add_mesh(const KbShape& shape, unsigned id) const;
  void add_analytic(const AnalyticShapes& shapes) const;
  void add_instance(RTCScene group, const KbShape& shape, unsigned id) const;
};

void SceneBuilder::add_mesh(const KbShape& shape, unsigned id) const {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!geometry) fail(device, "rtcNewGeometry");
  // Embree reads the vertex buffer with 16-byte loads: the scene's arrays carry one spare
  // vertex at their end.
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, flat.positions.data(), 0,
                             sizeof(KbFloat3), flat.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, flat.triangles.data(),
                             std::size_t{shape.first_triangle} * 3 * sizeof(uint32_t), 3 * sizeof(uint32_t),
                             shape.triangle_count);
  if (shape.flags & KB_SHAPE_NULL) rtcSetGeometryOccludedFilterFunction(geometry, pass_boundary);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

void SceneBuilder::add_analytic(const AnalyticShapes& shapes) const {
  if (shapes.ids.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  if (!geometry) fail(device, "rtcNewGeometry");
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(shapes.ids.size()));
  rtcSetGeometryUserData(geometry, const_cast<AnalyticShapes*>(&shapes));
  rtcSetGeometryBoundsFunction(geometry, analytic_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, analytic_intersect);
  rtcSetGeometryOccludedFunction(geometry, analytic_occluded);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, shapes.ids.front());
  rtcReleaseGeometry(geometry);
}

/// shape: the first of the instance, whose id is the instance's: no shape of the scene's own has it
void SceneBuilder::add_instance(RTCScene group, const KbShape& shape, unsigned id) const {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  if (!geometry) fail(device, "rtcNewGeometry");
  rtcSetGeometryInstancedScene(geometry, group);
  rtcSetGeometryTimeStepCount(geometry, 1);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, shape.to_world);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

RTCScene new_scene(RTCDevice device) {
  const RTCScene scene = rtcNewScene(device);
  if (!scene) fail(device, "rtcNewScene");
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  return scene;
}

/// The meshes of a group, numbered from 0.
RTCScene build_group(RTCDevice device, const FlatScene& flat, const MeshGroup& group) {
  const SceneBuilder builder{device, new_scene(device), flat};
  for (unsigned i = 0; i < group.shape_count; ++i) builder.add_mesh(flat.shapes[group.first_shape + i], i);
  rtcCommitScene(builder.scene);
  return builder.scene;
}

void add_instances(const SceneBuilder& builder) {
  std::vector<RTCScene> groups;
  for (const MeshGroup& group : builder.flat.groups)
    groups.push_back(build_group(builder.device, builder.flat, group));
  for (const MeshInstance& instance : builder.flat.instances)
    builder.add_instance(groups[instance.group], builder.flat.shapes[instance.first_shape],
                         instance.first_shape);
  for (const RTCScene group : groups) rtcReleaseScene(group);  // instances keep them
}

}  // namespace

AnalyticShapes::AnalyticShapes(const FlatScene& scene) : flat(scene) {
  for (uint32_t id = 0; id < flat.shapes.size(); ++id) {
    if (flat.shapes[id].type == KB_SHAPE_MESH) continue;
    ids.push_back(id);
    forms.push_back(shape_form(flat.shapes[id]));
  }
}

RTCScene build_embree_scene(RTCDevice device, const FlatScene& flat, const AnalyticShapes& analytic) {
  const SceneBuilder builder{device, new_scene(device), flat};
  for (unsigned id = 0; id < flat.shapes.size(); ++id) {
    const KbShape& shape = flat.shapes[id];
    if (shape.type == KB_SHAPE_MESH && !(shape.flags & KB_SHAPE_INSTANCED)) builder.add_mesh(shape, id);
  }
  builder.add_analytic(analytic);
  add_instances(builder);
  const ForeignOrder order(build_order);
  order.pass();
  rtcCommitScene(builder.scene);
  return builder.scene;
}

}  // namespace kiloband::cpu
