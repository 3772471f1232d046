// Light selection, sampling and densities. Spheres, disks and cylinders one lane after another (emitter.hpp).
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LIGHT_INL
#undef KILOBAND_LIGHT_INL
#else
#define KILOBAND_LIGHT_INL
#endif

#include "src_cpu/light/area.hpp"
#include "src_cpu/light/delta-inl.hpp"
#include "src_cpu/light/emitter.hpp"
#include "src_cpu/light/environment-inl.hpp"
#include "src_cpu/light/light_tree-inl.hpp"
#include "src_cpu/light/sun-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// One sample of direct light at a point.
struct Light {
  V3 direction;  // unit, from the shaded point towards the light
  V3 target;  // area and positional lights: the point on the light, moved off its surface towards its front
  F pdf;  // solid angle times selection probability [1/sr]; delta lights: selection probability; 0: no sample
  F factor;    // incident radiance (delta lights: irradiance) = factor * spectrum; about 1 for area lights
  M infinite;  // environment and directional lights, suns: no target
  M delta;     // cannot be hit by BSDF sampling
  Resolved radiance;
};

KB_INLINE Light select(M m, const Light& yes, const Light& no) {
  return {select(m, yes.direction, no.direction),
          select(m, yes.target, no.target),
          select(m, yes.pdf, no.pdf),
          select(m, yes.factor, no.factor),
          select(m, yes.infinite, no.infinite),
          select(m, yes.delta, no.delta),
          select(m, yes.radiance, no.radiance)};
}

KB_INLINE V3 no_vector() {
  return {F(0), F(0), F(0)};
}

/// The members of KbEmitter that area lights have. A scene's only emitter is read once for all lanes.
struct EmitterHead {
  U type, ref, shape;
  F select_pdf;
};
KB_INLINE EmitterHead gather_emitter(const FlatScene& scene, U emitter) {
  static_assert(offsetof(KbEmitter, ref) == 4 && offsetof(KbEmitter, select_pdf) == 12);
  if (const KbEmitter& only = scene.emitters.front(); scene.emitters.size() == 1)
    return {U(only.type), U(only.ref), U(only.shape), F(only.select_pdf)};
  U words[4];
  Addresses(scene.emitters.data(), emitter).load(0, words);
  return {words[0], words[1], words[2], as_floats(words[3])};
}

/// What next-event estimation has chosen: an emitter and, of a mesh in the light tree, a triangle.
struct ChosenLight {
  U emitter;
  EmitterHead head;  // select_pdf: the probability of this choice
  U triangle;        // KB_NONE: not chosen yet
  F area;            // of the triangle, m^2
};

/// By the tree, or one of the emitters that it does not have.
KB_INLINE ChosenLight choose_by_tree(const FlatScene& scene, V3 point, const F4& u, M active) {
  const M in_tree = active & (u.x < F(scene.emitter_cdf[1]));
  const auto entries = static_cast<uint32_t>(scene.emitter_cdf.size() - 1);
  const U entry = find_interval(scene.emitter_cdf.data(), U(0u), U(entries), u.x);
  U emitter = select(in_tree | (entry == U(0u)), U(0u), entry - U(1u));
  ChosenTreeLight chosen{U(0u), F(0)};
  U words[4] = {U(0u), U(KB_NONE), U(0u), U(0u)};
  if (any(in_tree)) {
    chosen = choose_tree_light(scene, point, u.x, u.y, in_tree);
    Addresses(scene.tree_lights.data(), select(in_tree, chosen.light, U(0u))).load(0, words);
    emitter = select(in_tree, words[0], emitter);
  }
  EmitterHead head = gather_emitter(scene, emitter);
  head.select_pdf = select(in_tree, chosen.probability, head.select_pdf);
  return {emitter, head, select(in_tree, words[1], U(KB_NONE)), as_floats(words[3])};
}

/// u: selection, triangle, position
KB_INLINE ChosenLight choose_light(const FlatScene& scene, V3 point, const F4& u, M active) {
  if (scene.features.light_tree) return choose_by_tree(scene, point, u, active);
  const auto emitters = static_cast<uint32_t>(scene.emitters.size());
  U emitter(0u);
  if (emitters > 1) emitter = find_interval(scene.emitter_cdf.data(), U(0u), U(emitters), u.x);
  return {emitter, gather_emitter(scene, emitter), U(KB_NONE), F(0)};
}

/// Area lights on meshes. record: of their shapes
KB_INLINE Light sample_mesh_light(const Lights& lights, const ChosenLight& chosen, const ShapeHead& record,
                                  V3 point, const F4& u, M active) {
  const FlatScene& scene = lights.scene;
  const U ref = chosen.head.ref;
  const bool textured = any(active & has_bits(ref, KB_REF_KIND_MASK));
  const MeshTriangle triangle = choose_triangle(scene, record, u.y, chosen.triangle, chosen.area, active);
  const AreaSample on_light = sample_mesh(lights, record, triangle, point, u.z, u.w, textured, active);
  Light light;
  light.direction = on_light.direction;
  light.target =
      on_light.position + on_light.normal * target_offset(on_light.offset, on_light.position - point);
  light.pdf = on_light.pdf * chosen.head.select_pdf;
  light.factor = on_light.factor;
  light.infinite = light.delta = no_lanes();
  light.radiance = resolve(scene, ref, {on_light.uv, on_light.triangle, on_light.barycentric},
                           active & (light.pdf > F(0)));
  return light;
}

/// Where light is wanted: a point, and the facing (shared/environment.h) of what receives it there.
struct Receiver {
  V3 point;
  U facing = U(KB_ALL_FACINGS);
};

/// Constant environments and maps. A map's density and radiance are those of the final direction, so that they are the
/// ones that a ray finds which leaves in the same direction.
KB_INLINE Light sample_environment(const FlatScene& scene, U facing, const F4& u, M active) {
  const V3 direction = sample_environment_direction(scene, facing, u.z, u.w, u.y);
  const V2 uv = environment_coordinates(scene, direction);
  return {direction, no_vector(), environment_pdf(scene, uv, facing),     F(1),
          active,    no_lanes(),  environment_radiance(scene, uv, active)};
}

KB_INLINE Light sample_suns(const FlatScene& scene, U emitter, const F4& u, M active) {
  const KbEmitter* emitters = scene.emitters.data();
  const F density = sun_density(KB_GATHER_FLOAT(emitters, KbEmitter, one_minus_cos, emitter),
                                KB_GATHER_FLOAT(emitters, KbEmitter, select_pdf, emitter));
  const U ref = KB_GATHER_WORD(emitters, KbEmitter, ref, emitter);
  return {sample_sun_direction(scene, emitter, u.z, u.w),       no_vector(), select(active, density, F(0)),
          KB_GATHER_FLOAT(emitters, KbEmitter, scale, emitter), active,      no_lanes(),
          resolve(scene, ref, place_at({F(0), F(0)}), active)};
}

/// Points, spots, projectors and directional lights.
KB_INLINE Light sample_delta_lights(const FlatScene& scene, const ChosenLight& chosen, V3 point, M active) {
  const U emitter = chosen.emitter, type = chosen.head.type;
  const M infinite = active & (type == U(KB_EMITTER_DIRECTIONAL)), near = active & !infinite;
  DeltaSample sample{no_vector(), no_vector(), F(0), {F(0), F(0)}};
  if (any(near))
    sample = sample_position(scene, emitter, near & (type == U(KB_EMITTER_SPOT)),
                             near & (type == U(KB_EMITTER_PROJECTOR)), point);
  if (any(infinite)) {
    const DeltaSample far = sample_directional(scene, emitter);
    sample = {select(infinite, far.direction, sample.direction), select(infinite, far.target, sample.target),
              select(infinite, far.factor, sample.factor), sample.uv};
  }
  const M lit = active & (sample.factor > F(0));
  return {sample.direction,
          sample.target,
          select(lit, chosen.head.select_pdf, F(0)),
          sample.factor,
          infinite,
          active,
          resolve(scene, chosen.head.ref, place_at(sample.uv), lit)};
}

/// What is emitted, in memory.
struct RadianceArrays {
  WordArray row, textured, texture, xy;
  FloatArray fx, fy;

  KB_INLINE explicit RadianceArrays(const Resolved& r)
      : row(r.row),
        textured(select(r.textured, U(1u), U(0u))),
        texture(r.sample.texture),
        xy(r.sample.xy),
        fx(r.sample.fx),
        fy(r.sample.fy) {}
  KB_INLINE void put(uint32_t i, const ResolvedSpectrum& one) {
    row[i] = one.row;
    textured[i] = one.textured;
    texture[i] = one.texture.texture, xy[i] = one.texture.xy;
    fx[i] = one.texture.fx, fy[i] = one.texture.fy;
  }
  KB_INLINE Resolved lanes() const { return {row, has_bits(textured, 1u), {texture, xy, fx, fy}}; }
};

/// `light` with samples of area lights on shapes of other kinds, and of thermal ones, in active lanes, where it has none.
/// finish  (lane, sample): what is left to be done with it
template <class Finish>
inline Light sample_shape_lights(const FlatScene& scene, const ChosenLight& chosen, V3 point, const F4& u,
                                 M active, const Light& light, const Finish& finish) {
  V3Array direction(light.direction), target(light.target);
  FloatArray pdf(light.pdf), factor(light.factor);
  RadianceArrays radiance(light.radiance);
  const V3Array at(point);
  const FloatArray u1(u.y), u2(u.z), u3(u.w), probability(chosen.head.select_pdf), area(chosen.area);
  const WordArray emitters(chosen.emitter), triangle(chosen.triangle);
  each_lane(active, [&](uint32_t i) KB_LAMBDA {
    LightSample one = sample_shape_light(scene, {emitters[i], probability[i], triangle[i], area[i]}, at[i],
                                         u1[i], {u2[i], u3[i]});
    finish(i, one);
    direction.put(i, one.direction);
    target.put(i, one.target);
    pdf[i] = one.pdf;
    factor[i] = one.factor;
    radiance.put(i, one.radiance);
  });
  return {direction, target, pdf, factor, light.infinite, light.delta, radiance.lanes()};
}

/// Samples of what has been chosen.
KB_INLINE Light sample_chosen(const Lights& lights, const ChosenLight& chosen, const Receiver& receiver,
                              const F4& u, M active) {
  const FlatScene& scene = lights.scene;
  const V3 point = receiver.point;
  const EmitterHead& head = chosen.head;
  const U type = head.type;
  const M on_shape = active & (type == U(KB_EMITTER_AREA));
  const M sky = active & (chosen.emitter == U(scene.environment));
  Light light{no_vector(), no_vector(), F(0), F(0), no_lanes(), no_lanes(), resolved_row(U(0u))};
  M mesh = on_shape;
  if (any(on_shape)) {
    const ShapeHead record = scene.emitters.size() == 1
                                 ? shared_shape(scene.shapes[scene.emitters[0].shape])
                                 : gather_shape(scene, select(on_shape, head.shape, U(0u)));
    mesh = on_shape & (record.type == U(KB_SHAPE_MESH)) & (record.first_cdf != U(KB_NONE));
    if (any(mesh)) light = sample_mesh_light(lights, chosen, record, point, u, mesh);
  }
  if (any(sky)) light = select(sky, sample_environment(scene, receiver.facing, u, sky), light);
  const M delta = active & ((type == U(KB_EMITTER_POINT)) | (type == U(KB_EMITTER_SPOT)) |
                            (type == U(KB_EMITTER_DIRECTIONAL)) | (type == U(KB_EMITTER_PROJECTOR)));
  if (any(delta)) light = select(delta, sample_delta_lights(scene, chosen, point, delta), light);
  const M sun = active & (type == U(KB_EMITTER_SUN));
  if (any(sun)) light = select(sun, sample_suns(scene, chosen.emitter, u, sun), light);
  const M others = active & !mesh & !sky & !delta & !sun;
  if (!any(others)) return light;
  return sample_shape_lights(scene, chosen, point, u, others, light, [](uint32_t, LightSample&) KB_LAMBDA {});
}

/// Selects an emitter by FlatScene::emitter_cdf (u.x) and a triangle of a mesh (u.y), or both by the light tree if there is one
/// (shared/light_tree.h), then a point or direction on it: environment maps by their texels, for the receiver's facing, with finer
/// digits from u.y; constant environments over the sphere; suns over their discs. Without thermally emitting shapes.
/// u: selection, triangle, position.
KB_INLINE Light sample_lights(const Lights& lights, const Receiver& receiver, const F4& u, M active) {
  return sample_chosen(lights, choose_light(lights.scene, receiver.point, u, active), receiver, u, active);
}

/// With which probability sample_lights() chooses what was hit, and the area [m^2] by which its points are chosen.
struct HitLight {
  F probability, area;
};
KB_INLINE HitLight chosen_as_light(const FlatScene& scene, const Hit& hit, U emitter, U triangle, V3 origin,
                                   M active) {
  const KbShape* shapes = scene.shapes.data();
  if (!scene.features.light_tree)
    return {KB_GATHER_FLOAT(scene.emitters.data(), KbEmitter, select_pdf, emitter),
            KB_GATHER_FLOAT(shapes, KbShape, area, hit.shape)};
  const M mesh = KB_GATHER_WORD(shapes, KbShape, type, hit.shape) == U(KB_SHAPE_MESH);
  const U light = gather(scene.first_tree_light.data(), emitter) + select(mesh & active, triangle, U(0u));
  U words[4];
  Addresses(scene.tree_lights.data(), select(active, light, U(0u))).load(0, words);
  const M in_tree = active & (words[2] != U(KB_NONE));
  return {tree_probability(scene, origin, select(in_tree, words[2], U(0u)), in_tree), as_floats(words[3])};
}

/// Density with which sample_lights() gives the direction from `origin` to a hit, selection included [1/sr], in active lanes, whose
/// shape has an emitter. 0 where the light does not emit to there (on_front()) or cannot be sampled.
/// triangle  of the mesh that was hit
/// origin    the `point` that was given to sample_lights(): for spheres the density depends on its side
KB_INLINE F area_light_pdf(const FlatScene& scene, const Hit& hit, U emitter, U triangle, V3 origin,
                           M active) {
  const KbShape* shapes = scene.shapes.data();
  const HitLight chosen = chosen_as_light(scene, hit, emitter, triangle, origin, active);
  const U type = KB_GATHER_WORD(shapes, KbShape, type, hit.shape);
  const M sampled =
      !((type == U(KB_SHAPE_MESH)) & (KB_GATHER_WORD(shapes, KbShape, first_cdf, hit.shape) == U(KB_NONE)));
  F density = area_density(hit.shape_flags, chosen.area, hit.geometric_normal, hit.shading_normal,
                           hit.point - origin);
  const M chosen_at_all = active & (chosen.probability > F(0));
  density = select(chosen_at_all & sampled, chosen.probability * density, F(0));
  const M sphere = chosen_at_all & (type == U(KB_SHAPE_SPHERE));
  if (!any(sphere)) return density;
  FloatArray result(density);
  const FloatArray probability(chosen.probability);
  const V3Array point(hit.point), from(origin);
  const WordArray shape(hit.shape);
  each_lane(sphere, [&](uint32_t i) KB_LAMBDA {
    result[i] = probability[i] * sphere_light_density(scene.shapes[shape[i]], from[i], point[i]);
  });
  return result;
}

/// What rays find that leave the scene: the density of sample_lights() where they come from, and the radiance, which is `scale` times a
/// spectrum.
struct Escape {
  F pdf;
  Resolved radiance;
  F scale;
};
/// Of the environment, which there is. facing: of where the rays come from
KB_INLINE Escape environment_at(const FlatScene& scene, V3 direction, U facing, M active) {
  const V2 uv = environment_coordinates(scene, direction);
  return {environment_pdf(scene, uv, facing), environment_radiance(scene, uv, active), F(1)};
}
/// Of a sun that they meet.
KB_INLINE Escape sun_at(const KbEmitter& sun) {
  return {sun_density(F(sun.one_minus_cos), F(sun.select_pdf)), resolved_row(U(sun.ref)), F(sun.scale)};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
