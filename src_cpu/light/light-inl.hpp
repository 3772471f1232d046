// Light selection, sampling and densities: emitter.hpp in lanes. Meshes in lanes, others one lane after another.
//
// For one lane or a vector of them: see src_cpu/lanes/one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LIGHT_INL
#undef KILOBAND_LIGHT_INL
#else
#define KILOBAND_LIGHT_INL
#endif

#include "src_cpu/geometry/texture-inl.hpp"
#include "src_cpu/light/area-inl.hpp"
#include "src_cpu/light/area.hpp"
#include "src_cpu/light/emitter.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

/// LightSample (emitter.hpp) in lanes; pdf 0: no sample.
struct Light {
  V3 direction, target;
  F pdf, factor;
  M infinite, delta;
  Resolved radiance;
};

/// Area lights on meshes.
KB_INLINE Light sample_mesh_light(const FlatScene& scene, U emitter, U shape, V3 point, const F4& u,
                                  M active) {
  const KbEmitter* emitters = scene.emitters.data();
  const U ref = KB_GATHER_WORD(emitters, KbEmitter, ref, emitter);
  const bool textured = any(active & has_bits(ref, KB_REF_KIND_MASK));
  const AreaSample on_light = sample_mesh(scene, shape, point, u.y, u.z, u.w, textured, active);
  Light light;
  light.direction = on_light.direction;
  light.target =
      on_light.position + on_light.normal * target_offset(on_light.offset, on_light.position - point);
  light.pdf = on_light.pdf * KB_GATHER_FLOAT(emitters, KbEmitter, select_pdf, emitter);
  light.factor = on_light.factor;
  light.infinite = light.delta = no_lanes();
  light.radiance = resolve(scene, ref, on_light.uv, active & (light.pdf > F(0)));
  return light;
}

/// Lights of other kinds.
inline void sample_other_lights(const FlatScene& scene, V3 point, const F4& u, M active, Light& light) {
  V3Array direction(light.direction), target(light.target);
  FloatArray pdf(light.pdf), factor(light.factor), fx(light.radiance.sample.fx), fy(light.radiance.sample.fy);
  WordArray row(light.radiance.row), texture(light.radiance.sample.texture), xy(light.radiance.sample.xy);
  const auto words = [](M m) KB_LAMBDA { return select(m, U(1u), U(0u)); };
  WordArray infinite(words(light.infinite)), delta(words(light.delta)),
      textured(words(light.radiance.textured));
  const V3Array at(point);
  const FloatArray u0(u.x), u1(u.y), u2(u.z), u3(u.w);
  each_lane(active, [&](uint32_t i) KB_LAMBDA {
    const LightSample one = sample_light(scene, {at.x[i], at.y[i], at.z[i]}, {u0[i], u1[i]}, {u2[i], u3[i]});
    direction.x[i] = one.direction.x, direction.y[i] = one.direction.y, direction.z[i] = one.direction.z;
    target.x[i] = one.target.x, target.y[i] = one.target.y, target.z[i] = one.target.z;
    pdf[i] = one.pdf;
    factor[i] = one.factor;
    infinite[i] = one.infinite, delta[i] = one.delta;
    row[i] = one.radiance.row;
    textured[i] = one.radiance.textured;
    texture[i] = one.radiance.texture.texture, xy[i] = one.radiance.texture.xy;
    fx[i] = one.radiance.texture.fx, fy[i] = one.radiance.texture.fy;
  });
  light = {direction,
           target,
           pdf,
           factor,
           has_bits(infinite, 1u),
           has_bits(delta, 1u),
           {row, has_bits(textured, 1u), {texture, xy, fx, fy}}};
}

/// sample_light() of emitter.hpp, without thermally emitting shapes. u: selection, triangle, position.
KB_INLINE Light sample_lights(const FlatScene& scene, V3 point, const F4& u, M active) {
  const auto emitters = static_cast<uint32_t>(scene.emitters.size());
  U emitter(0u);
  if (emitters > 1) emitter = find_interval(scene.emitter_cdf.data(), U(0u), U(emitters), u.x);
  const KbEmitter* records = scene.emitters.data();
  const M on_shape = KB_GATHER_WORD(records, KbEmitter, type, emitter) == U(KB_EMITTER_AREA);
  const U shape = select(on_shape, KB_GATHER_WORD(records, KbEmitter, shape, emitter), U(0u));
  const M mesh = active & on_shape &
                 (KB_GATHER_WORD(scene.shapes.data(), KbShape, type, shape) == U(KB_SHAPE_MESH)) &
                 (KB_GATHER_WORD(scene.shapes.data(), KbShape, first_cdf, shape) != U(KB_NONE));
  Light light{{F(0), F(0), F(0)}, {F(0), F(0), F(0)}, F(0), F(0), no_lanes(),
              no_lanes(),         resolved_row(U(0u))};
  if (any(mesh)) light = sample_mesh_light(scene, emitter, shape, point, u, mesh);
  if (any(active & !mesh)) sample_other_lights(scene, point, u, active & !mesh, light);
  return light;
}

/// area_light_pdf() of emitter.hpp: the density of hits, for active lanes, whose shape has an emitter.
KB_INLINE F area_light_pdf(const FlatScene& scene, const Hit& hit, U emitter, V3 origin, M active) {
  const KbShape* shapes = scene.shapes.data();
  const F select_pdf = KB_GATHER_FLOAT(scene.emitters.data(), KbEmitter, select_pdf, emitter);
  const U type = KB_GATHER_WORD(shapes, KbShape, type, hit.shape);
  const M sampled =
      !((type == U(KB_SHAPE_MESH)) & (KB_GATHER_WORD(shapes, KbShape, first_cdf, hit.shape) == U(KB_NONE)));
  F density = area_density(hit.shape_flags, KB_GATHER_FLOAT(shapes, KbShape, area, hit.shape),
                           hit.geometric_normal, hit.shading_normal, hit.point - origin);
  density = select(active & sampled & (select_pdf > F(0)), select_pdf * density, F(0));
  const M sphere = active & (type == U(KB_SHAPE_SPHERE)) & (select_pdf > F(0));
  if (!any(sphere)) return density;
  FloatArray result(density);
  const FloatArray chosen(select_pdf);
  const V3Array point(hit.point), from(origin);
  const WordArray shape(hit.shape);
  each_lane(sphere, [&](uint32_t i) KB_LAMBDA {
    result[i] = chosen[i] * sphere_light_density(scene.shapes[shape[i]], {from.x[i], from.y[i], from.z[i]},
                                                 {point.x[i], point.y[i], point.z[i]});
  });
  return result;
}

/// What escaped rays find: density of sample_lights() and radiance of the environment, which there is.
struct Escape {
  F pdf;
  Resolved radiance;
};
inline Escape environment_at(const FlatScene& scene, V3 direction, M active) {
  const KbEmitter& emitter = scene.emitters[scene.environment];
  if (emitter.type == KB_EMITTER_CONSTANT) {
    const F pdf(environment_pdf(scene, glm::vec3(0, 0, 1)));
    return {pdf, resolve(scene, U(emitter.ref), {F(0), F(0)}, active)};
  }
  FloatArray pdf(F(0)), fx(F(0)), fy(F(0));
  WordArray texture(U(0u)), xy(U(0u));
  const V3Array w(direction);
  each_lane(active, [&](uint32_t i) KB_LAMBDA {
    const glm::vec3 one(w.x[i], w.y[i], w.z[i]);
    pdf[i] = environment_pdf(scene, one);
    const KbTextureSample sample = environment_radiance(scene, one).texture;
    texture[i] = sample.texture, xy[i] = sample.xy;
    fx[i] = sample.fx, fy[i] = sample.fy;
  });
  return {pdf, {U(0u), active, {texture, xy, fx, fy}}};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
