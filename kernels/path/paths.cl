// The kernels of path generation. One iteration of the pool is
//   generate      ended paths are handed over, their slots take the next job (regeneration)
//   closest_hits  one ray of every live path
//   shade         one bounce of every live path: its vertex, a shadow ray, the next ray
//   any_hits      shadow rays; light that is hidden leaves the vertex
// and now and then
//   compact       slots without jobs leave the queue
// All run over a queue of slots: work-item i < count works on slot queue[i].
#include "geometry/bvh.clh"
#include "path/camera.clh"
#include "path/gas_path.clh"
#include "path/scatter.clh"
#include "shared/planted_faults.h"

/* Every slot starts in the state "ended" before its first job. */
__kernel void reset_pool(__global KbPathState* restrict states, __global kb_u32* restrict queue,
                         __global uint2* restrict tallies, kb_u32 pool) {
  const kb_u32 slot = (kb_u32)get_global_id(0);
  if (slot >= pool) return;
  KbPathState state;
  state.job = KB_NONE;
  state.flags = 0u;
  state.bound = state.magnitude = 0.0f;
  state.channel = state.chunk = KB_NONE;
  state.length = state.lit = 0u;
  states[slot] = state;
  queue[slot] = slot;
  tallies[slot] = (uint2)(0u, 0u);
}

/* The slot's next job that is a pixel of the round (the last pixels of a row of jobs are padding); KB_NONE: none. */
static inline kb_u32 next_job(const Pool* pool, kb_u32 job, kb_u32 slot) {
  const kb_u32 total = pool->round->samples * pool->round->padded_pixels;
  job = job == KB_NONE ? slot : job + pool->round->pool;
  while (job < total && job % pool->round->padded_pixels >= pool->round->pixels) job += pool->round->pool;
  return job < total ? job : KB_NONE;
}

/* A complete path becomes a saved one; with the method pt its light is in the film already. */
static inline void hand_over(const Pool* pool, const KbPathState* state) {
#if !KB_METHOD_PT
  pool->saved[state->job].count = state->flags & KB_PATH_INVALID ? KB_SAVED_INVALID : state->lit;
#endif
  if (!(state->flags & KB_PATH_INVALID)) return;
  const kb_u32 place = atomic_inc(&pool->faults->invalid);
  if (place < KB_LISTED_INVALID) pool->faults->invalid_jobs[place] = state->job;
}

__kernel void generate(KB_SCENE_PARAMS, KB_POOL_PARAMS, __global const kb_u32* restrict queue, kb_u32 count) {
  if (get_global_id(0) >= count) return;
  KB_SCENE_INIT(scene);
  KB_POOL_INIT(pool);
  const kb_u32 slot = queue[get_global_id(0)];
  KbPathState state = pool.states[slot];
  if (state.flags & (KB_PATH_LIVE | KB_PATH_FINISHED)) return;
  if (state.flags & KB_PATH_ENDED) hand_over(&pool, &state);
  state.job = next_job(&pool, state.job, slot);
  state.length = state.lit = 0u;
  if (state.job == KB_NONE) {
    state.flags = KB_PATH_FINISHED;
    pool.states[slot] = state;
    return;
  }
  state.flags = KB_PATH_LIVE | KB_PATH_PREVIOUS_DELTA;
  state.bound = state.magnitude = 1.0f;
  state.channel = KB_NONE;
#if KB_HAS_DISPERSION
  for (kb_u32 i = 0u; i < KB_CHANNEL_BINS && pool.round->dispersion; ++i) pool.dispersion[slot].carried[i] = 1.0f;
#endif
  const JobId id = job_id(&pool, &scene, state.job);
  const CameraRay camera =
      sample_camera_ray(&scene, id.pixel.x, id.pixel.y, kb_sampler_block(job_sampler(&pool, &id), KB_BLOCK_CAMERA));
  KbRay ray;
  vstore3(camera.origin, 0, ray.origin);
  vstore3(camera.direction, 0, ray.direction);
  vstore3(camera.origin, 0, ray.previous_point);
  ray.t_min = camera.t_min;
  ray.t_max = camera.t_max;
  ray.previous_pdf = 0.0f;
#if KB_HAS_GAS
  if (scene.constants->gas) pool.gas[slot] = gas_at_camera(&scene, ray.t_min);
#endif
  pool.rays[slot] = ray;
  pool.states[slot] = state;
}

__kernel void closest_hits(__global const KbShape* restrict shapes, __global const KbBvhNode* restrict nodes,
                           __global const KbPrimitive* restrict primitives, __global const KbPathState* restrict states,
                           __global const KbRay* restrict rays, __global KbHit* restrict hits,
                           __global KbFaults* restrict faults, __global uint2* restrict tallies,
                           __global const kb_u32* restrict queue, kb_u32 count) {
  if (get_global_id(0) >= count) return;
  const kb_u32 slot = queue[get_global_id(0)];
  if (!(states[slot].flags & KB_PATH_LIVE)) return;
  const KbRay ray = rays[slot];
  kb_u32 fault = 0u;
  hits[slot] = closest_hit(nodes, primitives, shapes, vload3(0, ray.origin), vload3(0, ray.direction), ray.t_min,
                           ray.t_max, &fault);
  ++tallies[slot].x;
  if (fault) atomic_or(&faults->code, fault);
}

/* One bounce of the path in `slot`, or its way to a null boundary. */
static inline void advance(Bounce* b, __global const KbBvhNode* nodes, __global const KbPrimitive* primitives,
                           const KbRay* ray, KbHit hit, __global KbFaults* faults) {
  b->direction = vload3(0, ray->direction);
  b->draft = empty_draft();
  b->has_shadow = false;
  bool goes_on = false, passes_boundary = false, fresh = b->bounce == 0u;
#if KB_HAS_GAS
  const bool gas = b->scene->constants->gas && b->scene->constants->max_depth != 0u;
  if (gas) {
    fresh = fresh && b->gas.crossings == 0u;
    passes_boundary = is_boundary(b->scene, primitives, hit);
    if (passes_boundary) goes_on = pass_boundary(b, nodes, primitives, ray, hit, faults);
    if (!passes_boundary && hit.primitive != KB_NONE) arrive_through_gas(b, ray, hit.t);
  }
#endif
  if (passes_boundary) {
    /* no bounce */
  } else if (b->scene->constants->max_depth == 0u) {
    /* nothing is seen, not even lights */
  } else if (hit.primitive == KB_NONE) {
    add_escaped(b, ray);
  } else {
    b->hit = make_surface_hit(b->scene, &primitives[hit.primitive], hit, vload3(0, ray->origin), b->direction);
    goes_on = shade_surface(b, ray);
  }
  if (goes_on && b->bounce + 1u >= KB_MAX_VERTICES) {
    b->state.flags |= KB_PATH_INVALID;
    goes_on = false;
  }
  if (!goes_on) b->state.flags = (b->state.flags & ~KB_PATH_LIVE) | KB_PATH_ENDED;
  b->state.flags = fresh ? b->state.flags | KB_PATH_FRESH : b->state.flags & ~KB_PATH_FRESH;
  if (goes_on && !passes_boundary) ++b->state.flags; /* the bounce number */
  (void)nodes, (void)faults;
}

__kernel void shade(KB_SCENE_PARAMS, KB_POOL_PARAMS, KB_CHANNEL_TABLE_PARAMS, __global const KbBvhNode* restrict nodes,
                    __global const KbPrimitive* restrict primitives, __global const KbHit* restrict hits,
                    __global uint2* restrict tallies, __global const kb_u32* restrict queue, kb_u32 count) {
  if (get_global_id(0) >= count) return;
  KB_SCENE_INIT(scene);
  KB_POOL_INIT(pool);
  Bounce b;
  b.slot = queue[get_global_id(0)];
  b.state = pool.states[b.slot];
  pool.shadows[b.slot].t_max = -1.0f;
#if KB_METHOD_PT
  b.state.length = 0u;
#endif
  if (!(b.state.flags & KB_PATH_LIVE)) {
    /* Nothing to add to the state of channels: the path's end has been taken note of. */
    pool.states[b.slot].length = b.state.length;
    return;
  }
  b.scene = &scene;
  b.pool = &pool;
  KB_CHANNEL_TABLE_INIT(b.tables, scene.constants->channels);
  b.id = job_id(&pool, &scene, b.state.job);
  b.key = job_sampler(&pool, &b.id);
  b.bounce = b.state.flags & KB_PATH_BOUNCE_MASK;
  const KbRay ray = pool.rays[b.slot];
  const kb_u32 before = b.state.length;
#if KB_HAS_GAS
  if (scene.constants->gas) b.gas = pool.gas[b.slot];
#endif
  advance(&b, nodes, primitives, &ray, hits[b.slot], pool.faults);
#if KB_HAS_GAS
  if (scene.constants->gas) pool.gas[b.slot] = b.gas;
#endif
  pool.states[b.slot] = b.state;
  if (b.state.flags & KB_PATH_LIVE) pool.rays[b.slot] = b.next;
  if (b.has_shadow) pool.shadows[b.slot] = b.shadow;
  tallies[b.slot].y += b.state.length > before ? 1u : 0u;
}

__kernel void any_hits(__global const KbShape* restrict shapes, __global const KbBvhNode* restrict nodes,
                       __global const KbPrimitive* restrict primitives, __global KbPathState* restrict states,
                       __global const KbShadowRay* restrict shadows, __global KbPathVertex* restrict arena,
                       __global KbFaults* restrict faults, __global uint2* restrict tallies,
                       __global const kb_u32* restrict queue, kb_u32 count) {
  if (get_global_id(0) >= count) return;
  const kb_u32 slot = queue[get_global_id(0)];
  const KbShadowRay ray = shadows[slot];
  if (ray.t_max < 0.0f) return;
  kb_u32 fault = 0u;
  const bool hidden =
      any_hit(nodes, primitives, shapes, vload3(0, ray.origin), vload3(0, ray.direction), ray.t_max, &fault);
  ++tallies[slot].x;
  if (fault) atomic_or(&faults->code, fault);
  if (!KB_PLANTED(LIGHT_HIDDEN) && hidden)
    arena[ray.vertex].head &= ~KB_VERTEX_NEE; /* its texture sample stays: it is the vertex's last */
  else
    states[slot].lit = states[slot].length;
}

#if KB_HAS_GAS
/* The same in scenes with gas: shadow rays pass null boundaries, and what they pass of gas becomes vertices. */
__kernel void shadow_walks(KB_SCENE_PARAMS, KB_POOL_PARAMS, __global const KbBvhNode* restrict nodes,
                           __global const KbPrimitive* restrict primitives, __global uint2* restrict tallies,
                           __global const kb_u32* restrict queue, kb_u32 count) {
  if (get_global_id(0) >= count) return;
  KB_SCENE_INIT(scene);
  KB_POOL_INIT(pool);
  const kb_u32 slot = queue[get_global_id(0)];
  const KbShadowRay ray = pool.shadows[slot];
  if (ray.t_max < 0.0f) return;
  KbPathState state = pool.states[slot];
  ShadowWalk walk = begin_shadow(&pool.gas[slot]);
  kb_u32 fault = 0u;
  const bool visible = walk_shadow(&scene, nodes, primitives, &ray, &walk, &fault);
  tallies[slot].x += walk.rays;
  if (fault) atomic_or(&pool.faults->code, fault);
  if (walk.invalid) state.flags |= KB_PATH_INVALID;
  if (visible) {
    append_columns(&scene, &pool, &state, slot, ray.vertex, &walk.columns);
    state.lit = state.length;
  } else {
    pool.arena[ray.vertex].head &= ~KB_VERTEX_NEE;
  }
  pool.states[slot] = state;
}
#endif

/* Slots that have not finished, in any order: results do not depend on it. */
__kernel void compact(__global const KbPathState* restrict states, __global const kb_u32* restrict queue,
                      __global kb_u32* restrict packed, __global KbFaults* restrict faults, kb_u32 count) {
  if (get_global_id(0) >= count) return;
  const kb_u32 slot = queue[get_global_id(0)];
  if (!(states[slot].flags & KB_PATH_FINISHED)) packed[atomic_inc(&faults->active)] = slot;
}

/* What the ray through a pixel's centre sees: depth, shading normal, shape, material (KbAuxiliary). */
__kernel void auxiliary(KB_SCENE_PARAMS, __global const KbBvhNode* restrict nodes,
                        __global const KbPrimitive* restrict primitives, __global KbAuxiliary* restrict out,
                        __global KbFaults* restrict faults, kb_u32 x0, kb_u32 y0, kb_u32 width, kb_u32 count) {
  const kb_u32 i = (kb_u32)get_global_id(0);
  if (i >= count) return;
  KB_SCENE_INIT(scene);
  const CameraRay ray = centre_camera_ray(&scene, x0 + i % width, y0 + i / width);
  kb_u32 fault = 0u;
  float3 origin = ray.origin;
  float passed = 0.0f;
  KbHit hit = closest_hit(nodes, primitives, scene.shapes, origin, ray.direction, ray.t_min, ray.t_max, &fault);
#if KB_HAS_GAS
  while (is_boundary(&scene, primitives, hit)) {
    const SurfaceHit boundary = make_surface_hit(&scene, &primitives[hit.primitive], hit, origin, ray.direction);
    passed += hit.t;
    origin = leave_surface(&boundary, ray.direction);
    hit = closest_hit(nodes, primitives, scene.shapes, origin, ray.direction, 0.0f, ray.t_max - passed, &fault);
  }
#endif
  if (fault) atomic_or(&faults->code, fault);
  KbAuxiliary pixel = {0.0f, {0.0f, 0.0f, 0.0f}, -1.0f, -1.0f};
  if (hit.primitive != KB_NONE) {
    const SurfaceHit surface_hit = make_surface_hit(&scene, &primitives[hit.primitive], hit, origin, ray.direction);
    const KbSurface surface = scene.surfaces[scene.shapes[surface_hit.shape].surface];
    const bool behind = dot(surface_hit.shading_normal, ray.direction) > 0.0f && surface.back != KB_NONE;
    pixel.depth = passed + hit.t;
    vstore3(surface_hit.shading_normal, 0, pixel.normal);
    pixel.object = (float)surface_hit.shape;
    pixel.material = (float)(behind ? surface.back : surface.front);
  }
  out[i] = pixel;
}
