// One bounce of a wave: emission, next-event estimation, scattering, roulette.
//
// Estimator: path_tracer.hpp. The stages stand in the order in which kernels/path has them; what few scenes have is code for
// one path at a time: gas (GasPaths), told lane by lane, and dispersion (DispersedPaths), which one lane alone calls. Thermal
// emission: thermal-inl.hpp.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_SHADE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_SHADE_INL
#undef KILOBAND_SHADE_INL
#else
#define KILOBAND_SHADE_INL
#endif

#include "src_cpu/path/part_rays-inl.hpp"
#include "src_cpu/path/shading-inl.hpp"
#include "src_cpu/path/thermal-inl.hpp"
#ifdef KB_ONE_LANE
#include "src_cpu/path/dispersed_paths.hpp"
#endif

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

KB_INLINE void append_escape(Shading& s, const Escape& seen, M escaped) {
  Vertex v = empty_vertex();
  v.set(escaped, KB_VERTEX_EMIT);
  v.set(escaped & seen.radiance.textured, KB_VERTEX_TEX_EMIT);
  v.emission = seen.radiance;
  const F mis = select(s.previous_delta(), F(1), power_heuristic(s.previous_pdf(), seen.pdf));
  v.emit_weight = mis * seen.scale;
  append(s.wave, s.path, v, escaped);
}

/// Rays that left the scene see the environment and, in front of it, the suns that they meet: a vertex each.
KB_INLINE void add_escaped(Shading& s) {
  const FlatScene& scene = s.scene();
  if (s.bounce.number == 0 && scene.integrator.hide_emitters) return;
  if (scene.environment != KB_NONE) {
    const U facing = s.has_facings() ? s.state_word(offsetof(PathState, facing)) : U(KB_ALL_FACINGS);
    append_escape(s, environment_at(scene, s.direction, facing, s.active), s.active);
  }
  for (std::size_t i = scene.first_sun; i < scene.emitters.size(); ++i) {
    const M met = s.active & meets_sun(scene.emitters[i], s.direction);
    if (any(met)) append_escape(s, sun_at(scene.emitters[i]), met);
  }
}

/// Where textures are looked up.
KB_INLINE TexturePlace texture_place(const Shading& s) {
  if (!s.scene().features.mesh_attribute) return place_at(s.hit.uv);
  const RayQueue& rays = s.wave.rays();
  return {s.hit.uv, load(rays.primitive + s.first), {load(rays.u + s.first), load(rays.v + s.first)}};
}

/// Emission of area lights that were hit.
KB_INLINE void add_emission(Shading& s, M hit) {
  const FlatScene& scene = s.scene();
  if (scene.features.thermal) hit = hit & !add_thermal_emission(s, hit);
  if (s.bounce.number == 0 && scene.integrator.hide_emitters) return;
  const M emits = hit & (s.hit.emitter != U(KB_NONE)) & on_front(s.hit.shading_normal, -s.direction);
  if (!any(emits)) return;
  const U index = select(emits, s.hit.emitter, U(0u));
  const M weighted = emits & !s.previous_delta();
  F weight(1);
  if (any(weighted)) {
    const U triangle = load(s.wave.rays().primitive + s.first);
    const F pdf = area_light_pdf(scene, s.hit, index, triangle, s.previous_point(), weighted);
    weight = select(weighted, power_heuristic(s.previous_pdf(), pdf), F(1));
  }
  s.vertex.set(emits, KB_VERTEX_EMIT);
  s.vertex.emit_weight = select(emits, weight, s.vertex.emit_weight);
  const Resolved emission =
      resolve(scene, KB_GATHER_WORD(scene.emitters.data(), KbEmitter, ref, index), texture_place(s), emits);
  s.vertex.emission = scene.features.thermal ? select(emits, emission, s.vertex.emission) : emission;
  s.vertex.set(emits & emission.textured, KB_VERTEX_TEX_EMIT);
}

/// Blends choose one of their surfaces, masks whether the ray passes; both by u.x, which is uniform again afterwards.
/// Returns the surfaces.
inline U choose_surfaces(Shading& s, U surface, M hit) {
  const FlatScene& scene = s.scene();
  const TexturePlace place = texture_place(s);
  F x = s.u.x;
  if (scene.features.blend) surface = chosen_surface(scene, surface, place, x, hit);
  s.opacity = opacity_at(scene, surface, place, hit);
  const M masked = s.opacity < F(1);
  s.passes = hit & masked & (x >= s.opacity);
  const F again = select(s.passes, (x - s.opacity) / (F(1) - s.opacity), x / s.opacity);
  s.u.x = select(masked, min(again, F(KB_ONE_MINUS_EPSILON)), x);
  return surface;
}

/// Normals that bump and normal maps turn, and the tangents that they leave.
inline V3 bump_normals(Shading& s, M seen, M turned, V3& tangent) {
  const V3 n = s.hit.shading_normal;
  const U triangle = load(s.wave.rays().primitive + s.first);
  const BumpedNormal bumped =
      bumped_normals(s.scene(), s.side, {s.hit.shape, triangle, s.hit.uv, n, -s.direction, turned}, seen);
  tangent = select(bumped.mapped, tangent - n * dot(n, tangent), tangent);
  s.alpha2 = bumped.alpha2;
  return bumped.normal;
}

/// Roughness that varies over surfaces, mostly alike in both directions.
KB_INLINE void look_up_roughness(Shading& s, const TexturePlace& place, M seen) {
  const FlatScene& scene = s.scene();
  const U u = KB_GATHER_WORD(scene.roughness.data(), KbRoughness, alpha_u_ref, s.side),
          v = KB_GATHER_WORD(scene.roughness.data(), KbRoughness, alpha_v_ref, s.side);
  s.material.alpha_u = number_at(scene, u, place, s.material.alpha_u, seen);
  const M alike = (u == v) & (u != U(KB_NONE));
  s.material.alpha_v = number_at(scene, v, place, s.material.alpha_v, seen & !alike);
  s.material.alpha_v = select(seen & alike, s.material.alpha_u, s.material.alpha_v);
}

/// The numbers of principled materials, of the numbers' maps the values here.
inline void look_up_principled(Shading& s, const TexturePlace& place, M seen) {
  const FlatScene& scene = s.scene();
  const M lanes = seen & is_type(s.material.type, KB_MATERIAL_PRINCIPLED);
  if (!any(lanes)) return;
  s.principled = gather_principled(scene.tables.data(), select(lanes, s.material.table, U(0u)), lanes);
  s.material.principled = &s.principled;
  if (scene.features.principled_map) {
    const U first = s.side * U(KB_PRINCIPLED_MAPPED);
    for (uint32_t n = 0; n < KB_PRINCIPLED_MAPPED; ++n) {
      F& number = s.principled.number[n];
      number = number_at(scene, gather(scene.principled_maps.data(), first + U(n)), place, number, lanes);
    }
  }
  set_principled_alpha(s.material, lanes);
}

/// Whose facets lie along the tangent. Those by which light passes a thin principled sheet have a roughness of their own.
KB_INLINE M is_anisotropic(const Shading& s, M seen) {
  M anisotropic = seen & (s.material.alpha_u != s.material.alpha_v);
  if (s.scene().features.principled) {
    const M sheet = seen & is_type(s.material.type, KB_MATERIAL_PRINCIPLED) &
                    has_bits(s.material.flags, KB_MATERIAL_THIN);
    if (any(sheet))
      anisotropic = anisotropic | (sheet & (s.principled.number[KB_PRINCIPLED_ANISOTROPIC] > F(0)));
  }
  return anisotropic;
}

/// What of an environment map the surface may receive light from.
KB_INLINE void find_facing(Shading& s) {
  const M both_sides = has_bits(s.surface_flags, KB_SURFACE_TRANSMISSIVE);
  const KbEmitter& environment = s.scene().emitters[s.scene().environment];
  s.facing = select(both_sides, U(KB_ALL_FACINGS), facing_of(environment, s.frame.z));
}

/// The material that is seen, its spectra, the frame and the direction to where the path comes from. Returns the
/// lanes that have a material which scatters.
KB_INLINE M find_material(Shading& s, U surface, M hit) {
  const FlatScene& scene = s.scene();
  static_assert(offsetof(KbSurface, front) == 0 && offsetof(KbSurface, flags) == 8);
  U record[4];
  Addresses(scene.surfaces.data(), surface).load(0, record);
  s.surface_flags = record[2];
  const M below = dot(s.hit.shading_normal, -s.direction) < F(0);
  const M turned = below & has_bits(s.surface_flags, KB_SURFACE_TWO_SIDED);
  const M black = below & !has_bits(s.surface_flags, KB_SURFACE_TWO_SIDED | KB_SURFACE_TRANSMISSIVE);
  const M seen = hit & !black;
  s.side = select(seen, select(turned, record[1], record[0]), U(0u));
  s.material = gather_material(scene.materials.data(), scene.tables.data(), s.side);
  const U ref_a = s.material.ref_a, ref_b = s.material.ref_b;
  const TexturePlace place = texture_place(s);
  s.vertex.a = resolve(scene, ref_a, place, seen & (ref_a != U(KB_NONE)));
  s.vertex.b = resolve(scene, ref_b, place, seen & (ref_b != U(KB_NONE)));
  s.material.bound_a = bound_at(scene, ref_a, s.vertex.a, s.material.bound_a, seen & (ref_a != U(KB_NONE)));
  s.material.bound_b = bound_at(scene, ref_b, s.vertex.b, s.material.bound_b, seen & (ref_b != U(KB_NONE)));
  if (scene.features.roughness_map) look_up_roughness(s, place, seen);
  if (scene.features.principled) look_up_principled(s, place, seen);
  V3 tangent = s.hit.tangent;
  const V3 normal = scene.features.bump ? bump_normals(s, seen, turned, tangent) : s.hit.shading_normal;
  s.frame = make_frame(normal);
  if (const M anisotropic = is_anisotropic(s, seen); any(anisotropic)) {
    const Frame along = make_frame(normal, tangent);
    s.frame.x = select(anisotropic, along.x, s.frame.x);
    s.frame.y = select(anisotropic, along.y, s.frame.y);
  }
  const F sign = select(turned, F(-1), F(1));  // the frame seen from behind stays right-handed
  s.frame.y = s.frame.y * sign;
  s.frame.z = s.frame.z * sign;
  if (scene.features.bump) s.unbumped = s.hit.shading_normal * sign;
  s.wi = s.frame.to_local(-s.direction);
  if (s.has_facings()) find_facing(s);
  return seen & ((s.material.bound_a != F(0)) | (s.material.bound_b != F(0)));
}

/// Next-event estimation: stores the weights as if the light were visible, and queues the shadow rays. Returns the
/// lanes that have one; the vertices that they belong to are noted by note_shadow_rays().
KB_INLINE M add_light(Shading& s, M scatters) {
  const FlatScene& scene = s.scene();
  if (scene.emitters.empty()) return no_lanes();
  const M smooth = scatters & has_smooth_lobe(s.material.type);
  if (!any(smooth)) return smooth;
  const Light light = sample_lights(s, smooth);
  M lit = smooth & (light.pdf > F(0)) & (light.factor > F(0));
  if (!any(lit)) return lit;
  const BsdfValue value = eval_bsdf(s.material, s.wi, s.frame.to_local(light.direction), lit);
  lit = lit & ((value.w0 >= F(KB_LEAST_BSDF_VALUE)) | (abs(value.w1) >= F(KB_LEAST_BSDF_VALUE)));
  const F mis = select(light.delta, F(1), power_heuristic(light.pdf, value.pdf * s.opacity));
  F weight = mis * s.opacity * light.factor / light.pdf;
  if (scene.features.bump) weight = weight * bump_share(s, light.direction);
  lit = lit & (weight != F(0));
  // A rough dielectric reflects with S_a and transmits with S_b: as two terms, one vertex carries both.
  const M boundary = lit & (s.material.type == U(KB_MATERIAL_ROUGH_DIELECTRIC));
  const M second = boundary & value.lobe_b;
  const M conductor = s.vertex.kind() == U(KB_KIND_CONDUCTOR);
  const F other = select(conductor, value.w1, select(boundary, F(0), weight * value.w1));
  s.vertex.nee0 = select(lit & !second, weight * value.w0, F(0));
  s.vertex.nee1 = select(lit, select(second, weight * value.w0, other), F(0));
  s.vertex.set_kind(boundary, U(KB_KIND_TWO_TERM));
  s.vertex.set(lit, KB_VERTEX_NEE);
  s.vertex.light = light.radiance;
  s.vertex.light.row = select(lit, light.radiance.row, U(0u));
  s.vertex.set(lit & light.radiance.textured, KB_VERTEX_TEX_NEE);
  queue_shadow_rays(s, light, lit);
  return lit;
}

/// What a bump map leaves of a sample.
KB_INLINE void bump_sample(const Shading& s, BsdfSample& sample) {
  const F share = bump_share(s, s.frame.to_world(sample.wo));
  const M two = (sample.kind == U(KB_KIND_TWO_TERM)) | (sample.kind == U(KB_KIND_NONLINEAR)) |
                (sample.kind == U(KB_KIND_TINTED));
  sample.w0 = sample.w0 * share;
  sample.w1 = select(two, sample.w1 * share, sample.w1);
  sample.bound = sample.bound * share;
}

/// Scattering, roulette, the next ray. A mask's transparent part: the ray goes on as if nothing were there. Shadow rays
/// stop at masks, so what lies behind is found by this ray alone and gets weight 1.
KB_INLINE void scatter(Shading& s, M hit, M scatters, M lit) {
  const M sampled = scatters & !s.passes;
  BsdfSample sample = sample_bsdf(s.material, s.wi, s.u.x, {s.u.y, s.u.z}, sampled);
#ifdef KB_ONE_LANE
  if (sample.needs_channel.v) s.bounce.dispersion->refract_one_channel(s, sample);
#endif
  const M conductor = sampled & (sample.kind == U(KB_KIND_CONDUCTOR));
  if (any(conductor)) sample.bound = sample.bound * conductor_bound(s.material, sample.w1, conductor);
  if (s.scene().features.bump) bump_sample(s, sample);
  M alive = sampled & (sample.pdf > F(0)) & (sample.bound > F(0));
  const M two =
      alive & (s.material.type == U(KB_MATERIAL_ROUGH_DIELECTRIC)) & (s.vertex.kind() == U(KB_KIND_TWO_TERM));
  s.vertex.set(alive, KB_VERTEX_SCATTER);
  s.vertex.set_kind(alive & !two, sample.kind);
  s.vertex.scatter0 = select(alive, select(two & sample.lobe_b, F(0), sample.w0), F(0));
  const F second = select(two, select(sample.lobe_b, sample.w0, F(0)), sample.w1);
  s.vertex.scatter1 = select(alive, second, F(0));
  F bound = s.state_float(offsetof(PathState, bound)) * select(alive, sample.bound, F(1));
  alive = roulette(s, bound, alive);
  finish_spectra(s.vertex, lit | alive,
                 alive & sample.lobe_b & !two & (s.material.type != U(KB_MATERIAL_DIFFUSE)));
  V3 direction = s.frame.to_world(sample.wo);
  const M delta = alive & sample.delta;
  if (any(delta))
    direction = select(delta, normalize(direction), direction);  // rounding would add up along chains
  const M goes_on = alive | s.passes;
  if (!any(goes_on)) return;
  continue_paths(s, select(s.passes, s.direction, direction), bound,
                 select(s.passes, F(0), sample.pdf * s.opacity), s.passes | delta, goes_on & hit);
}

/// The gas that paths have come through, or that they leave the scene through.
KB_INLINE void pass_gas(Shading& s, bool escapes) {
  if (!s.bounce.gas) return;
  const WordArray paths(s.path);
  each_lane(s.active, [&](uint32_t i) KB_LAMBDA { s.bounce.gas->append(s.wave, paths[i], escapes); });
}

/// Lanes `first` .. of the rays that have hit nothing.
inline void leave_scene(const Bounce& bounce, Wave& wave, uint32_t first) {
  Shading s(bounce, wave, wave.escaped, first);
  pass_gas(s, true);
  add_escaped(s);
}

/// Lanes `first` .. of the wave's rays, which have all hit something.
inline void shade_lanes(const Bounce& bounce, Wave& wave, uint32_t first) {
  const RayQueue& rays = wave.rays();
  Shading s(bounce, wave, rays, first);
  const M hit = s.active;
  pass_gas(s, false);
  const V3 origin{load(rays.ox + first), load(rays.oy + first), load(rays.oz + first)};
  make_hit({bounce.scene, bounce.records}, load(rays.shape + first), load(rays.primitive + first),
           load(rays.u + first), load(rays.v + first), origin, s.direction, load(rays.t_max + first), hit,
           s.hit);
  add_emission(s, hit);
  if (!bounce.goes_on()) return append(wave, s.path, s.vertex, hit & s.vertex.has(KB_VERTEX_EMIT));
  s.keys = s.sampler_keys();
  s.u = s.numbers(kb_block_bsdf(bounce.number));
  s.opacity = F(1);
  s.passes = no_lanes();
  U surface = s.hit.surface;
  if (bounce.scene.features.mask || bounce.scene.features.blend) surface = choose_surfaces(s, surface, hit);
  const M scatters = find_material(s, surface, hit);
  if (bounce.scene.features.compensation) choose_compensation(s, scatters);
#ifdef KB_ONE_LANE
  if (bounce.dispersion && scatters.v && bounce.dispersion->shade(s)) return;
#endif
  s.vertex.head = select(scatters,
                         s.vertex.head | eval_kind(s.material.type, s.material.flags) |
                             shift_left<KB_VERTEX_MATERIAL_SHIFT>(s.side),
                         s.vertex.head);
  const M lit = add_light(s, scatters);
  scatter(s, hit, scatters, lit);
  append(wave, s.path, s.vertex, hit & s.vertex.has(KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER));
  note_shadow_rays(wave, lit);
}

/// The paths of the wave's rays at what these have hit, or on their way out of the scene.
inline void shade_rays(const Bounce& bounce, Wave& wave) {
  part_rays(bounce, wave);
  if (bounce.scene.environment != KB_NONE || bounce.scene.features.sun || bounce.gas)
    for (uint32_t first = 0; first < wave.escaped.count; first += kLanes) leave_scene(bounce, wave, first);
  const RayQueue& rays = wave.rays();
  for (uint32_t first = 0; first < rays.count; first += kLanes) {
    const uint32_t next = first + kLanes;
    if (bounce.prefetches && next < rays.count)
      prefetch_records({bounce.scene, bounce.records}, load(rays.shape + next), load(rays.primitive + next),
                       first_lanes(rays.count - next));
    shade_lanes(bounce, wave, first);
  }
  end_lanes();
}

/// All paths of the wave but those of rare_rays: fills the queues of shadow rays and next rays.
inline void shade_wave(const Bounce& bounce, Wave& wave) {
  wave.shadow_rays.count = wave.next_rays().count = 0;
  shade_rays(bounce, wave);
}

/// The paths of rare_rays, in the place of those that are done. They join the queues behind the others.
inline void shade_rare_rays(const Bounce& bounce, Wave& wave) {
  RayQueue& rays = wave.rays();
  rays.count = wave.rare_rays.count;
  for (uint32_t first = 0; first < rays.count; first += kLanes)
    move_rays(wave.rare_rays, first, first_lanes(rays.count - first), rays, first);
  Bounce one_by_one = bounce;
  one_by_one.rare_shapes = nullptr;
  shade_rays(one_by_one, wave);
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
