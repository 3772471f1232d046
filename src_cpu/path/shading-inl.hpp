// A vector of paths at what their rays have hit, and the steps that ordinary and rare surfaces share.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_SHADING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_SHADING_INL
#undef KILOBAND_SHADING_INL
#else
#define KILOBAND_SHADING_INL
#endif

#include "src_cpu/bsdf/bsdf-inl.hpp"
#include "src_cpu/geometry/bump-inl.hpp"
#include "src_cpu/light/light-inl.hpp"
#include "src_cpu/path/gas_paths.hpp"
#include "src_cpu/path/vertex-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// Veach's power heuristic with beta = 2: the weight of the technique with density pdf against one with
/// density other. Safe for densities whose squares would overflow.
KB_INLINE F power_heuristic(F pdf, F other) {
  const F ratio = other / pdf;
  return select(pdf < F(kInfinity), F(1) / (F(1) + ratio * ratio), F(1));
}

/// A vector of paths at what their rays have hit. Masks name lanes of it.
struct Shading {
  const Bounce& bounce;
  Wave& wave;
  uint32_t first;  // in the queue
  U path;
  M active;  // lanes that have a path
  V3 direction;
  Vertex vertex;

  Hit hit;
  SamplerKeys keys;
  F4 u;  // of the BSDF: lobe, direction, roulette
  U surface_flags;
  M passes;  // through a mask
  F opacity;
  U side;  // the material that is seen
  Material material;
  Principled principled;  // only in scenes with principled materials
  Frame frame;
  V3 wi;
  U facing;  // only in scenes with an environment map: shared/environment.h
  // Only in scenes with bump maps:
  V3 unbumped;  // the normal without, on the frame's side
  F alpha2;     // BumpedNormal::alpha2

  /// What is not set here is left as it is: the compiler would fill 2 KiB with zeros.
  /// Queue: RayQueue or EscapeQueue; lanes `from` .. of it
  template <class Queue>
  KB_INLINE Shading(const Bounce& at, Wave& of, const Queue& queue, uint32_t from)
      : bounce(at),
        wave(of),
        first(from),
        path(select(first_lanes(queue.count - from), load(queue.path + from), U(kWavePaths))),
        active(first_lanes(queue.count - from)),
        direction{load(queue.dx + from), load(queue.dy + from), load(queue.dz + from)},
        vertex(empty_vertex()) {}

  KB_INLINE const FlatScene& scene() const { return bounce.scene; }
  KB_INLINE bool has_facings() const { return scene().envmap.height > 0; }
  KB_INLINE Receiver receiver() const { return {hit.point, has_facings() ? facing : U(KB_ALL_FACINGS)}; }
  KB_INLINE F state_float(std::size_t offset) const { return gather_float(wave.paths.data(), offset, path); }
  KB_INLINE U state_word(std::size_t offset) const { return gather_word(wave.paths.data(), offset, path); }
  /// What of the paths' keys differs between paths is all that is read of them.
  KB_INLINE SamplerKeys sampler_keys() const {
    SamplerKeys read{U(0u), U(bounce.id.sample), U(kb_reverse_bits(bounce.id.index)), U(0u), U(0u)};
    if (bounce.sampler() == KB_SAMPLER_INDEPENDENT) {
      read.pixel = state_word(offsetof(PathState, film_pixel));
    } else {
      read.key0 = state_word(offsetof(PathState, key0));
      read.key1 = state_word(offsetof(PathState, key1));
    }
    return read;
  }
  KB_INLINE F4 numbers(uint32_t block) const {
    return sampler_block(bounce.sampler(), bounce.settings.seed, keys, U(block));
  }
  KB_INLINE M previous_delta() const { return has_bits(state_word(offsetof(PathState, previous_delta)), 1u); }
  KB_INLINE F previous_pdf() const { return state_float(offsetof(PathState, previous_pdf)); }
  KB_INLINE V3 previous_point() const {
    const std::size_t at = offsetof(PathState, previous_point);
    return {state_float(at), state_float(at + 4), state_float(at + 8)};
  }
};

/// What of light from or into `direction` a bump map leaves (src_cpu/geometry/bump-inl.hpp); 1 without one.
KB_INLINE F bump_share(const Shading& s, V3 direction) {
  const F c = dot(direction, s.unbumped), bumped = dot(direction, s.frame.z), c2 = c * c;
  const M same = ((c > F(0)) & (bumped > F(0))) | ((c < F(0)) & (bumped < F(0)));
  const F masked = F(2) * abs(c) / (abs(c) + sqrt(c2 + s.alpha2 * max(F(1) - c2, F(0))));
  const F share = select(same, select(s.alpha2 > F(0), masked, F(1)), F(0));
  return select(s.alpha2 < F(0), F(1), share);
}

/// Gas is told of the rays that lanes m send off: in their queue from place `ray` on.
inline void tell_gas(Shading& s, M m, uint32_t ray,
                     void (GasPaths::*tell)(Wave&, const Departure&, uint32_t)) {
  const V3Array points(s.hit.point), normals(s.hit.geometric_normal), arrivals(s.direction);
  const WordArray paths(s.path), shapes(s.hit.shape);
  each_lane(m, [&](uint32_t i) KB_LAMBDA {
    (s.bounce.gas->*tell)(s.wave, {paths[i], shapes[i], points[i], normals[i], arrivals[i]}, ray++);
  });
}

/// Queues the shadow rays of light samples; the vertices that they belong to are noted by note_shadow_rays().
KB_INLINE void queue_shadow_rays(Shading& s, const Light& light, M lit) {
  ShadowQueue& queue = s.wave.shadow_rays;
  const V3 origin = leave_surface(s.hit.departure, s.hit.geometric_normal, s.hit.offset, light.direction);
  const V3 way = select(light.infinite, light.direction, light.target - origin);
  const uint32_t n = queue.count;
  store_chosen(origin, lit, queue.ox + n, queue.oy + n, queue.oz + n);
  store_chosen(way, lit, queue.dx + n, queue.dy + n, queue.dz + n);
  store_chosen(select(light.infinite, F(kInfinity), F(1)), lit, queue.t_max + n);
  store_chosen(s.path, lit, queue.path + n);
  if (s.bounce.gas) tell_gas(s, lit, n, &GasPaths::note_shadow_ray);
}

/// The shadow rays that add_light() has queued belong to the vertices that their paths have saved last.
KB_INLINE void note_shadow_rays(Wave& wave, M lit) {
  ShadowQueue& queue = wave.shadow_rays;
  const uint32_t end = queue.count + count(lit);
  for (uint32_t i = queue.count; i < end; ++i) queue.entry[i] = wave.paths[queue.path[i]].last_entry;
  queue.count = end;
}

/// Survival q = min(1, bound): never below what any channel still carries, so no channel's variance becomes infinite.
KB_INLINE M roulette(Shading& s, F& bound, M scattered) {
  if (s.bounce.number + 1 < static_cast<uint32_t>(s.scene().integrator.rr_depth)) return scattered;
  const F q = select(scattered, min(F(1), bound), F(1));
  const M survives = scattered & (s.u.w < q);
  s.vertex.clear(scattered & !survives, KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
  s.vertex.scatter0 = s.vertex.scatter0 / q;
  s.vertex.scatter1 = select(s.vertex.has_two_weights(), s.vertex.scatter1 / q, s.vertex.scatter1);
  bound = bound / q;
  return survives;
}

/// What goes on: the queue's next rays, and what the next bounce must know of the paths.
KB_INLINE void continue_paths(Shading& s, V3 direction, F bound, F pdf, M delta, M goes_on) {
  RayQueue& next = s.wave.next_rays();
  const V3 origin = leave_surface(s.hit.departure, s.hit.geometric_normal, s.hit.offset, direction);
  const uint32_t n = next.count;
  store_chosen(origin, goes_on, next.ox + n, next.oy + n, next.oz + n);
  store_chosen(direction, goes_on, next.dx + n, next.dy + n, next.dz + n);
  store_chosen(s.path, goes_on, next.path + n);
  store(F(0), next.t_min + n);
  store(F(kInfinity), next.t_max + n);
  next.count += count(goes_on);
  if (s.bounce.gas) tell_gas(s, goes_on, n, &GasPaths::follow_ray);
  const V3Array point(s.hit.point);
  const FloatArray bounds(bound), pdfs(pdf);
  const uint32_t deltas = bits_of(delta);
  const WordArray paths(s.path);
  each_lane(goes_on, [&](uint32_t i) KB_LAMBDA {
    PathState& state = s.wave.paths[paths[i]];
    state.previous_point[0] = point.x[i];
    state.previous_point[1] = point.y[i];
    state.previous_point[2] = point.z[i];
    state.previous_pdf = pdfs[i];
    state.bound = bounds[i];
    state.previous_delta = deltas >> i & 1;
  });
  if (!s.has_facings()) return;
  const WordArray facings(s.facing);
  each_lane(goes_on, [&](uint32_t i) KB_LAMBDA { s.wave.paths[paths[i]].facing = facings[i]; });
}

/// The factors S_a and S_b that the vertex needs, and their lookups. use_b: S_b stands in the place of S_a.
KB_INLINE void finish_spectra(Vertex& v, M needed, M use_b) {
  v.a = select(use_b, v.b, v.a);
  const M two = needed & v.has_two_spectra();
  v.a.row = select(needed, v.a.row, U(0u));
  v.b.row = select(two, v.b.row, U(0u));
  v.set(needed & v.a.textured, KB_VERTEX_TEX_A);
  v.set(two & v.b.textured, KB_VERTEX_TEX_B);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
