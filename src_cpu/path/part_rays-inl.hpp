// Rays of a wave by what they have found: something to be shaded, something for one path at a time, nothing.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_PART_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_PART_RAYS_INL
#undef KILOBAND_PART_RAYS_INL
#else
#define KILOBAND_PART_RAYS_INL
#endif

#include "src_cpu/lanes/lane_access-inl.hpp"
#include "src_cpu/path/wave.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// Moves chosen lanes from `first` on to `at`: all but where the search began. from and to may be one, with at <= first.
KB_INLINE void move_rays(const RayQueue& from, uint32_t first, M chosen, RayQueue& to, uint32_t at) {
  const auto move = [&](const auto* array, auto* target)
                        KB_LAMBDA { store_chosen(load(array + first), chosen, target + at); };
  move(from.ox, to.ox), move(from.oy, to.oy), move(from.oz, to.oz);
  move(from.dx, to.dx), move(from.dy, to.dy), move(from.dz, to.dz);
  move(from.t_max, to.t_max), move(from.u, to.u), move(from.v, to.v);
  move(from.primitive, to.primitive), move(from.shape, to.shape), move(from.path, to.path);
}

/// Moves the rays that have hit something together, in their order, those that have not to `escaped`, and those that are for one
/// path at a time to `rare_rays`: so vectors of each are full.
inline void part_rays(const Bounce& bounce, Wave& wave) {
  RayQueue& rays = wave.rays();
  EscapeQueue& escaped = wave.escaped;
  uint32_t hits = 0;
  escaped.count = 0;
  for (uint32_t first = 0; first < rays.count; first += kLanes) {
    const M active = first_lanes(rays.count - first);
    const U shape = load(rays.shape + first);
    M hit = active & (shape != U(KB_NONE));
    const M miss = active & !hit;
    if (any(miss)) {
      const uint32_t n = escaped.count;
      store_chosen(load(rays.dx + first), miss, escaped.dx + n);
      store_chosen(load(rays.dy + first), miss, escaped.dy + n);
      store_chosen(load(rays.dz + first), miss, escaped.dz + n);
      store_chosen(load(rays.path + first), miss, escaped.path + n);
      escaped.count += count(miss);
    }
    if (bounce.rare_shapes) {
      const M rare = hit & (gather(bounce.rare_shapes, select(hit, shape, U(0u))) != U(0u));
      if (any(rare)) {
        move_rays(rays, first, rare, wave.rare_rays, wave.rare_rays.count);
        wave.rare_rays.count += count(rare);
        hit = hit & !rare;
      }
    }
    if (hits != first || any(active & !hit)) move_rays(rays, first, hit, rays, hits);
    hits += count(hit);
  }
  rays.count = hits;
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
