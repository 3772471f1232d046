#include "src_cpu/geometry/embree_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <string>
#include <type_traits>

#include "base/error.hpp"
#include "src_cpu/geometry/boundary.hpp"
#include "src_cpu/geometry/embree_build.hpp"

namespace kiloband::cpu {
namespace {

constexpr auto kCoherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
constexpr auto kIncoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;

const char* embree_name(Isa isa) {
  switch (isa == Isa::kAuto ? resolve_isa(isa) : isa) {
    case Isa::kAvx512:
      return "avx512";
    case Isa::kAvx2:
      return "avx2";
    default:
      return "sse4.2";
  }
}

RTCIntersectContext query_context(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

}  // namespace

struct EmbreeScene::Impl {
  explicit Impl(const FlatScene& of) : flat(&of), analytic(of) {}

  const FlatScene* flat;
  AnalyticShapes analytic;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RayGrid grid;  // of the geometry
  bool boundaries = has_boundaries(*flat);

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  /// Not with instances: Embree 3.13.5 (avx512) does not come back from rtcOccluded16 with the coherent flag in scenes
  /// that have user geometry and instances (the zoo's "instances").
  bool coherent_packets() const { return !flat->features.instances; }
  /// Embree's ids of an instance and of a mesh in it, as the shape's.
  static void find_shape(TraceRay& ray) {
    if (ray.instance != KB_NONE) ray.shape += ray.instance;
  }
  /// Large meshes do not fit the caches: asks for the hit triangle's indices while the next ray is traced.
  void prefetch_triangle(const TraceRay& ray) const {
    if (ray.shape == KB_NONE) return;
    const KbShape& shape = flat->shapes[ray.shape];
    if (shape.type == KB_SHAPE_MESH) {
      __builtin_prefetch(&flat->triangles[3 * (std::size_t{shape.first_triangle} + ray.primitive)]);
    }
  }
};

EmbreeScene::EmbreeScene(const FlatScene& scene, Isa isa, int threads)
    : impl_(std::make_unique<Impl>(scene)) {
  const std::string config = fmt::format("isa={},threads={}", embree_name(isa), threads);
  impl_->device = rtcNewDevice(config.c_str());
  if (!impl_->device) throw DeviceError("Embree: cannot create a device with " + config);
  if (impl_->boundaries &&
      !rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED))
    throw DeviceError("Embree was built without filter functions, which null boundaries need");
  impl_->scene = build_embree_scene(impl_->device, scene, impl_->analytic);
  RTCBounds bounds;
  rtcGetSceneBounds(impl_->scene, &bounds);
  impl_->grid = RayGrid({bounds.lower_x, bounds.lower_y, bounds.lower_z},
                        {bounds.upper_x, bounds.upper_y, bounds.upper_z});
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE)
    throw DeviceError("Embree: building the scene failed");
}

EmbreeScene::~EmbreeScene() = default;

static_assert(sizeof(TraceRay) == sizeof(RTCRayHit) && sizeof(ShadowRay) == sizeof(RTCRay));
static_assert(offsetof(TraceRay, t_max) == offsetof(RTCRay, tfar) &&
              offsetof(TraceRay, flags) == offsetof(RTCRay, flags));
static_assert(offsetof(TraceRay, u) == offsetof(RTCRayHit, hit) + offsetof(RTCHit, u));
static_assert(offsetof(TraceRay, shape) == offsetof(RTCRayHit, hit) + offsetof(RTCHit, geomID));
static_assert(offsetof(TraceRay, instance) == offsetof(RTCRayHit, hit) + offsetof(RTCHit, instID));

void EmbreeScene::closest_hits(std::span<TraceRay> rays) const {
  RTCIntersectContext context = query_context(kIncoherent);
  for (TraceRay& ray : rays) {
    rtcIntersect1(impl_->scene, &context, reinterpret_cast<RTCRayHit*>(&ray));
    Impl::find_shape(ray);
    impl_->prefetch_triangle(ray);
  }
}

void EmbreeScene::occlusions(std::span<ShadowRay> rays) const {
  OcclusionContext context{query_context(kIncoherent), nullptr};
  for (ShadowRay& ray : rays) rtcOccluded1(impl_->scene, &context.embree, reinterpret_cast<RTCRay*>(&ray));
}

// ---- the rays of a wave ------------------------------------------------------------------------------

namespace {

/// Below this many triangles sorted coherent packets are faster (measured: +35 % with 38 triangles, +12 to 18 % with
/// 1,000 to 4,500, -15 to -19 % with 70,000 to 100,000).
constexpr std::size_t kMostTrianglesSorted = 10000;

template <int N>
using RayPacket = std::conditional_t<N == 16, RTCRay16, RTCRay8>;
template <int N>
using HitPacket = std::conditional_t<N == 16, RTCRayHit16, RTCRayHit8>;

void intersect(const int* valid, RTCScene scene, RTCIntersectContext& context, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &context, &rays);
}
void intersect(const int* valid, RTCScene scene, RTCIntersectContext& context, RTCRayHit8& rays) {
  rtcIntersect8(valid, scene, &context, &rays);
}

constexpr uint32_t whole_packets(uint32_t count, uint32_t size) {
  return (count + size - 1) / size * size;
}

/// Lanes past the end are not valid, and copies of the last ray: Embree may look at them (with SSE4.2 it splits packets
/// of 16, and asserts that all of them are finite).
template <class Queue>
void fill_last_packet(Queue& rays, uint32_t size) {
  for (uint32_t i = rays.count; i < whole_packets(rays.count, size); ++i)
    copy_query(rays, rays.count - 1, rays, i);
}

/// What is the same for all packets of a queue. Rays begin at 0, unless others are loaded.
template <int N>
void prepare(RayPacket<N>& packet) {
  std::fill_n(packet.tnear, N, 0.0f);
  std::fill_n(packet.time, N, 0.0f);
  std::fill_n(packet.mask, N, ~0u);
  std::fill_n(packet.id, N, 0u);
  std::fill_n(packet.flags, N, 0u);
}

template <int N, class Queue>
void load_rays(const Queue& rays, uint32_t first, RayPacket<N>& packet, int (&valid)[N]) {
  const auto copy = [&](const float* from, float(&to)[N]) { std::memcpy(to, from + first, sizeof to); };
  copy(rays.ox, packet.org_x);
  copy(rays.oy, packet.org_y);
  copy(rays.oz, packet.org_z);
  copy(rays.dx, packet.dir_x);
  copy(rays.dy, packet.dir_y);
  copy(rays.dz, packet.dir_z);
  copy(rays.t_max, packet.tfar);
  for (uint32_t i = 0; i < N; ++i) valid[i] = first + i < rays.count ? -1 : 0;
}

template <int N>
void store_hits(const HitPacket<N>& packet, bool instances, uint32_t first, RayQueue& rays) {
  const auto copy = [&](const auto(&from)[N], auto* to) { std::memcpy(to + first, from, sizeof from); };
  copy(packet.ray.tfar, rays.t_max);
  copy(packet.hit.u, rays.u);
  copy(packet.hit.v, rays.v);
  copy(packet.hit.primID, rays.primitive);
  copy(packet.hit.geomID, rays.shape);
  if (!instances) return;
  for (uint32_t i = 0; i < N; ++i)
    if (packet.hit.instID[0][i] != KB_NONE) rays.shape[first + i] += packet.hit.instID[0][i];
}

template <int N>
void trace_packets(RTCScene scene, RTCIntersectContextFlags flags, bool instances, RayQueue& rays) {
  RTCIntersectContext context = query_context(flags);
  alignas(64) HitPacket<N> packet;
  alignas(64) int valid[N];
  fill_last_packet(rays, N);
  prepare<N>(packet.ray);
  for (uint32_t first = 0; first < rays.count; first += N) {
    load_rays(rays, first, packet.ray, valid);
    std::memcpy(packet.ray.tnear, rays.t_min + first, sizeof packet.ray.tnear);
    std::fill_n(packet.hit.geomID, N, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], N, RTC_INVALID_GEOMETRY_ID);
    intersect(valid, scene, context, packet);
    store_hits<N>(packet, instances, first, rays);
  }
}

}  // namespace

bool EmbreeScene::sorting_pays() const {
  return impl_->coherent_packets() && impl_->flat->triangles.size() / 3 < kMostTrianglesSorted;
}

const RayGrid& EmbreeScene::grid() const {
  return impl_->grid;
}

void EmbreeScene::closest_hits(RayQueue& rays, RayPackets packets) const {
  const bool instances = impl_->flat->features.instances;
  if (packets == RayPackets::kCoherent && impl_->coherent_packets())
    trace_packets<16>(impl_->scene, kCoherent, instances, rays);
  else
    trace_packets<8>(impl_->scene, kIncoherent, instances, rays);
}

void EmbreeScene::occlusions(ShadowQueue& rays, RayPackets packets) const {
  const bool coherent = packets == RayPackets::kCoherent && impl_->coherent_packets();
  OcclusionContext context{query_context(coherent ? kCoherent : kIncoherent), nullptr};
  alignas(64) RTCRay16 packet;
  alignas(64) int valid[16];
  fill_last_packet(rays, 16);
  prepare<16>(packet);
  std::iota(packet.id, packet.id + 16, 0);
  if (impl_->boundaries) std::fill_n(rays.passes, rays.count, 0);
  for (uint32_t first = 0; first < rays.count; first += 16) {
    load_rays(rays, first, packet, valid);
    if (impl_->boundaries) context.passes = rays.passes + first;
    rtcOccluded16(valid, impl_->scene, &context.embree, &packet);
    std::memcpy(rays.t_max + first, packet.tfar, sizeof packet.tfar);
  }
}

}  // namespace kiloband::cpu
