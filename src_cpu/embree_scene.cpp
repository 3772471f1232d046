#include "src_cpu/embree_scene.hpp"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "base/error.hpp"
#include "src_cpu/shape_geometry.hpp"

namespace kiloband {
namespace {

#if RTC_VERSION_MAJOR >= 4
struct Query {
  RTCIntersectArguments intersect;
  RTCOccludedArguments occlude;
  explicit Query(RTCRayQueryFlags flags) {
    rtcInitIntersectArguments(&intersect);
    rtcInitOccludedArguments(&occlude);
    intersect.flags = occlude.flags = flags;
  }
};
constexpr auto kCoherent = RTC_RAY_QUERY_FLAG_COHERENT;
constexpr auto kIncoherent = RTC_RAY_QUERY_FLAG_INCOHERENT;
#else
struct Query {
  RTCIntersectContext context;
  explicit Query(RTCIntersectContextFlags flags) {
    rtcInitIntersectContext(&context);
    context.flags = flags;
  }
};
constexpr auto kCoherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
constexpr auto kIncoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif

void intersect1(RTCScene scene, Query& query, RTCRayHit& ray) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(scene, &ray, &query.intersect);
#else
  rtcIntersect1(scene, &query.context, &ray);
#endif
}

void occluded1(RTCScene scene, Query& query, RTCRay& ray) {
#if RTC_VERSION_MAJOR >= 4
  rtcOccluded1(scene, &ray, &query.occlude);
#else
  rtcOccluded1(scene, &query.context, &ray);
#endif
}

void intersect16(const int* valid, RTCScene scene, Query& query, RTCRayHit16& rays) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect16(valid, scene, &rays, &query.intersect);
#else
  rtcIntersect16(valid, scene, &query.context, &rays);
#endif
}

/// Interval that an analytic shape covers along one axis, from that row of its to_world: a circle or sphere of unit radius
/// reaches |row| to both sides; a cylinder also spans its axis. Grown by a few units in the last place.
void axis_bounds(const KbShape& shape, int axis, float& low, float& high) {
  const float* row = &shape.to_world[4 * axis];
  const double round = row[0] * double{row[0]} + row[1] * double{row[1]};
  const double reach = std::sqrt(shape.type == KB_SHAPE_SPHERE ? round + row[2] * double{row[2]} : round);
  const double along = shape.type == KB_SHAPE_CYLINDER ? row[2] : 0;
  const double from = row[3] + std::min(0.0, along) - reach;
  const double to = row[3] + std::max(0.0, along) + reach;
  const double slack = 1e-6 * std::max({std::abs(from), std::abs(to), reach});
  low = static_cast<float>(from - slack);
  high = static_cast<float>(to + slack);
}

void analytic_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& shape = *static_cast<const KbShape*>(args->geometryUserPtr);
  axis_bounds(shape, 0, args->bounds_o->lower_x, args->bounds_o->upper_x);
  axis_bounds(shape, 1, args->bounds_o->lower_y, args->bounds_o->upper_y);
  axis_bounds(shape, 2, args->bounds_o->lower_z, args->bounds_o->upper_z);
}

bool hit_shape(const KbShape& shape, RTCRayN* rays, unsigned count, unsigned lane, double& t) {
  const glm::dvec3 origin(RTCRayN_org_x(rays, count, lane), RTCRayN_org_y(rays, count, lane), RTCRayN_org_z(rays, count, lane));
  const glm::dvec3 direction(RTCRayN_dir_x(rays, count, lane), RTCRayN_dir_y(rays, count, lane),
                             RTCRayN_dir_z(rays, count, lane));
  return intersect_analytic(shape, origin, direction, RTCRayN_tnear(rays, count, lane), RTCRayN_tfar(rays, count, lane), t);
}

void analytic_intersect(const RTCIntersectFunctionNArguments* args) {
  const auto& shape = *static_cast<const KbShape*>(args->geometryUserPtr);
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    double t = 0;
    if (args->valid[lane] != -1 || !hit_shape(shape, rays, args->N, lane, t)) continue;
    RTCRayN_tfar(rays, args->N, lane) = static_cast<float>(t);
    RTCHitN_geomID(hits, args->N, lane) = args->geomID;
    RTCHitN_primID(hits, args->N, lane) = 0;
    RTCHitN_instID(hits, args->N, lane, 0) = RTC_INVALID_GEOMETRY_ID;
    RTCHitN_u(hits, args->N, lane) = 0;
    RTCHitN_v(hits, args->N, lane) = 0;
  }
}

void analytic_occluded(const RTCOccludedFunctionNArguments* args) {
  const auto& shape = *static_cast<const KbShape*>(args->geometryUserPtr);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    double t = 0;
    if (args->valid[lane] != -1 || !hit_shape(shape, args->ray, args->N, lane, t)) continue;
    RTCRayN_tfar(args->ray, args->N, lane) = -std::numeric_limits<float>::infinity();
  }
}

[[noreturn]] void fail(RTCDevice device, const char* what) {
  const RTCError code = rtcGetDeviceError(device);
  throw DeviceError(fmt::format("Embree: {} failed (error {})", what, static_cast<int>(code)));
}

}  // namespace

void RayQueue::reserve(std::size_t count) {
  const std::size_t padded = (count + kPacketSize - 1) / kPacketSize * kPacketSize;
  for (auto* array : {&ox, &oy, &oz, &dx, &dy, &dz, &t_min, &t_max}) array->resize(padded);
}

void RayQueue::push(const float (&origin)[3], const float (&direction)[3], float near_t, float far_t) {
  ox[size] = origin[0];
  oy[size] = origin[1];
  oz[size] = origin[2];
  dx[size] = direction[0];
  dy[size] = direction[1];
  dz[size] = direction[2];
  t_min[size] = near_t;
  t_max[size] = far_t;
  ++size;
}

void HitQueue::resize(std::size_t count) {
  const std::size_t padded = (count + kPacketSize - 1) / kPacketSize * kPacketSize;
  if (t.size() >= padded) return;
  for (auto* array : {&t, &u, &v}) array->resize(padded);
  for (auto* array : {&shape, &primitive}) array->resize(padded);
}

struct EmbreeScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  void add_mesh(const FlatScene& flat, const KbShape& shape, unsigned id);
  void add_analytic(const KbShape& shape, unsigned id);
};

void EmbreeScene::Impl::add_mesh(const FlatScene& flat, const KbShape& shape, unsigned id) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!geometry) fail(device, "rtcNewGeometry");
  // Embree reads the vertex buffer with 16-byte loads: the scene's arrays carry one spare vertex at their end.
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, flat.positions.data(), 0,
                             sizeof(KbFloat3), flat.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, flat.triangles.data(),
                             std::size_t{shape.first_triangle} * 3 * sizeof(uint32_t), 3 * sizeof(uint32_t),
                             shape.triangle_count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::Impl::add_analytic(const KbShape& shape, unsigned id) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  if (!geometry) fail(device, "rtcNewGeometry");
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcSetGeometryUserData(geometry, const_cast<KbShape*>(&shape));
  rtcSetGeometryBoundsFunction(geometry, analytic_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, analytic_intersect);
  rtcSetGeometryOccludedFunction(geometry, analytic_occluded);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

EmbreeScene::EmbreeScene(const FlatScene& scene, const std::string& isa, int threads) : impl_(std::make_unique<Impl>()) {
  const std::string config = fmt::format("isa={},threads={}", isa, threads);
  impl_->device = rtcNewDevice(config.c_str());
  if (!impl_->device) throw DeviceError("Embree: cannot create a device with " + config);
  impl_->scene = rtcNewScene(impl_->device);
  if (!impl_->scene) fail(impl_->device, "rtcNewScene");
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_HIGH);
  for (unsigned id = 0; id < scene.shapes.size(); ++id) {
    const KbShape& shape = scene.shapes[id];
    shape.type == KB_SHAPE_MESH ? impl_->add_mesh(scene, shape, id) : impl_->add_analytic(shape, id);
  }
  rtcCommitScene(impl_->scene);
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE) throw DeviceError("Embree: building the scene failed");
}

EmbreeScene::~EmbreeScene() = default;

namespace {

/// Copies packet `first` of the queue; lanes past its end are invalid.
void load_packet(const RayQueue& rays, std::size_t first, RTCRay16& ray, int (&valid)[kPacketSize]) {
  const auto copy = [first](const std::vector<float>& from, float* to) { std::copy_n(&from[first], kPacketSize, to); };
  copy(rays.ox, ray.org_x);
  copy(rays.oy, ray.org_y);
  copy(rays.oz, ray.org_z);
  copy(rays.dx, ray.dir_x);
  copy(rays.dy, ray.dir_y);
  copy(rays.dz, ray.dir_z);
  copy(rays.t_min, ray.tnear);
  copy(rays.t_max, ray.tfar);
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    valid[lane] = first + lane < rays.size ? -1 : 0;
    ray.time[lane] = 0;
    ray.mask[lane] = ~0u;
    ray.id[lane] = 0;
    ray.flags[lane] = 0;
  }
}

RTCRay load_ray(const RayQueue& rays, std::size_t i) {
  RTCRay ray{};
  ray.org_x = rays.ox[i];
  ray.org_y = rays.oy[i];
  ray.org_z = rays.oz[i];
  ray.dir_x = rays.dx[i];
  ray.dir_y = rays.dy[i];
  ray.dir_z = rays.dz[i];
  ray.tnear = rays.t_min[i];
  ray.tfar = rays.t_max[i];
  ray.mask = ~0u;
  return ray;
}

}  // namespace

void EmbreeScene::closest_hits(const RayQueue& rays, HitQueue& hits, RayMode mode) const {
  hits.resize(rays.size);
  if (mode == RayMode::kSingle) {
    Query query(kIncoherent);
    for (std::size_t i = 0; i < rays.size; ++i) {
      RTCRayHit ray{};
      ray.ray = load_ray(rays, i);
      ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      intersect1(impl_->scene, query, ray);
      hits.t[i] = ray.ray.tfar;
      hits.u[i] = ray.hit.u;
      hits.v[i] = ray.hit.v;
      hits.shape[i] = ray.hit.geomID;
      hits.primitive[i] = ray.hit.primID;
    }
    return;
  }
  Query query(kCoherent);
  alignas(64) RTCRayHit16 packet;
  alignas(64) int valid[kPacketSize];
  for (std::size_t first = 0; first < rays.size; first += kPacketSize) {
    load_packet(rays, first, packet.ray, valid);
    std::fill_n(packet.hit.geomID, kPacketSize, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kPacketSize, RTC_INVALID_GEOMETRY_ID);
    intersect16(valid, impl_->scene, query, packet);
    std::copy_n(packet.ray.tfar, kPacketSize, &hits.t[first]);
    std::copy_n(packet.hit.u, kPacketSize, &hits.u[first]);
    std::copy_n(packet.hit.v, kPacketSize, &hits.v[first]);
    std::copy_n(packet.hit.geomID, kPacketSize, &hits.shape[first]);
    std::copy_n(packet.hit.primID, kPacketSize, &hits.primitive[first]);
  }
}

void EmbreeScene::occlusions(const RayQueue& rays, std::vector<uint8_t>& occluded) const {
  occluded.resize(rays.size);
  Query query(kIncoherent);
  for (std::size_t i = 0; i < rays.size; ++i) {
    RTCRay ray = load_ray(rays, i);
    occluded1(impl_->scene, query, ray);
    occluded[i] = ray.tfar < 0;
  }
}

std::size_t EmbreeScene::bare_queries(const RayQueue& closest, const RayQueue& shadow,
                                      std::span<const uint32_t> order) const {
  Query query(kIncoherent);
  std::size_t hits = 0;
  for (const uint32_t code : order) {
    if (code & 1) {
      RTCRay ray = load_ray(shadow, code >> 1);
      occluded1(impl_->scene, query, ray);
      hits += ray.tfar < 0;
    } else {
      RTCRayHit ray{};
      ray.ray = load_ray(closest, code >> 1);
      ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      intersect1(impl_->scene, query, ray);
      hits += ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
  }
  return hits;
}

}  // namespace kiloband
