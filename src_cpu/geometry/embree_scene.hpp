// With embree_build.hpp the one place that knows Embree (3.13).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "src_cpu/geometry/ray_order.hpp"
#include "src_cpu/lanes/isa.hpp"

namespace kiloband::cpu {

/// A closest-hit query and its answer, laid out as Embree's RTCRayHit so that nothing is copied. direction
/// need not be a unit vector; hits lie in (t_min, t_max).
struct alignas(16) TraceRay {
  float ox, oy, oz, t_min;
  float dx, dy, dz, time = 0;
  float t_max;  // in: far end; out: the hit's distance
  uint32_t mask = ~0u, id = 0, flags = 0;
  float ng_x, ng_y, ng_z;       // not used
  float u = 0, v = 0;           // barycentric coordinates of a mesh hit
  uint32_t primitive = 0;       // triangle within the shape
  uint32_t shape = KB_NONE;     // KB_NONE: a miss
  uint32_t instance = KB_NONE;  // first shape of the instance that was hit, or KB_NONE

  TraceRay(glm::vec3 origin, glm::vec3 direction, float near_t, float far_t)
      : ox(origin.x),
        oy(origin.y),
        oz(origin.z),
        t_min(near_t),
        dx(direction.x),
        dy(direction.y),
        dz(direction.z),
        t_max(far_t) {}
  glm::vec3 origin() const { return {ox, oy, oz}; }
  glm::vec3 direction() const { return {dx, dy, dz}; }
};

/// An occlusion query, laid out as Embree's RTCRay; t_max < 0 afterwards: something is in between, null
/// boundaries aside.
struct alignas(16) ShadowRay {
  float ox, oy, oz, t_min;
  float dx, dy, dz, time = 0;
  float t_max;
  uint32_t mask = ~0u, id = 0, flags = 0;

  ShadowRay(glm::vec3 origin, glm::vec3 direction, float far_t)
      : ox(origin.x),
        oy(origin.y),
        oz(origin.z),
        t_min(0),
        dx(direction.x),
        dy(direction.y),
        dz(direction.z),
        t_max(far_t) {}
  glm::vec3 origin() const { return {ox, oy, oz}; }
  glm::vec3 direction() const { return {dx, dy, dz}; }
  bool occluded() const { return t_max < 0; }
};

/// What a queue asks for a ray, without an answer.
inline TraceRay query_of(const RayQueue& rays, uint32_t i) {
  return {{rays.ox[i], rays.oy[i], rays.oz[i]},
          {rays.dx[i], rays.dy[i], rays.dz[i]},
          rays.t_min[i],
          rays.t_max[i]};
}
inline ShadowRay query_of(const ShadowQueue& rays, uint32_t i) {
  return {{rays.ox[i], rays.oy[i], rays.oz[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]}, rays.t_max[i]};
}

/// A ray of a queue with its answer.
inline TraceRay ray_of(const RayQueue& rays, uint32_t i) {
  TraceRay ray = query_of(rays, i);
  ray.u = rays.u[i];
  ray.v = rays.v[i];
  ray.primitive = rays.primitive[i];
  ray.shape = rays.shape[i];
  return ray;
}

/// And back; whose ray it is stays.
inline void put_ray(const TraceRay& ray, RayQueue& rays, uint32_t i) {
  rays.ox[i] = ray.ox, rays.oy[i] = ray.oy, rays.oz[i] = ray.oz;
  rays.dx[i] = ray.dx, rays.dy[i] = ray.dy, rays.dz[i] = ray.dz;
  rays.t_min[i] = ray.t_min, rays.t_max[i] = ray.t_max;
  rays.u[i] = ray.u, rays.v[i] = ray.v;
  rays.primitive[i] = ray.primitive, rays.shape[i] = ray.shape;
}

/// How far Embree's distances to triangles may be off, relative, where the plane's height and the cosine are exact. It multiplies by
/// a reciprocal: where there is no AVX-512, RCPPS, off by 1.5 * 2^-12 at most (Intel's and AMD's manuals), after a step of Newton's
/// method, which squares that; and four roundings.
inline constexpr double kEmbreeDistanceError = (2.25 + 4) * 0x1p-24;

class EmbreeScene {
 public:
  /// The scene must outlive this object.
  /// isa: Embree's own code path, whose hits differ in their last bits; kAuto: the best of this machine.
  /// throws DeviceError naming Embree's error
  EmbreeScene(const FlatScene& scene, Isa isa, int threads);
  ~EmbreeScene();

  /// One ray after the other, answers in place.
  void closest_hits(std::span<TraceRay> rays) const;
  void occlusions(std::span<ShadowRay> rays) const;

  /// In packets, the rays of a wave. What lies behind the last ray is overwritten, up to a whole packet.
  void closest_hits(RayQueue& rays, RayPackets packets) const;
  void occlusions(ShadowQueue& rays, RayPackets packets) const;
  /// Whether secondary and shadow rays of this scene are best sorted and then coherent: by the number of its
  /// triangles, never by time. With instances never.
  bool sorting_pays() const;
  const RayGrid& grid() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kiloband::cpu
