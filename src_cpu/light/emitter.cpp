#include "src_cpu/light/emitter.hpp"

#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
#include "src_cpu/light/area.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/light-inl.hpp"

namespace kiloband::cpu {
namespace {

EmittedRadiance radiance_of(const FlatScene& scene, uint32_t ref, glm::vec2 uv) {
  const ResolvedSpectrum resolved = resolve_spectrum(scene, ref, uv);
  return {resolved.row, resolved.textured, resolved.texture};
}

EmittedRadiance radiance_of(const one_lane::Resolved& r) {
  return {static_cast<uint16_t>(r.row.v),
          r.textured.v,
          {r.sample.texture.v, r.sample.xy.v, r.sample.fx.v, r.sample.fy.v}};
}

}  // namespace

LightSample sample_shape_light(const FlatScene& scene, const SelectedLight& selected, glm::vec3 point,
                               float u_triangle, glm::vec2 u) {
  const KbEmitter& emitter = scene.emitters[selected.emitter];
  const KbShape& shape = scene.shapes[emitter.shape];
  const bool thermal = emitter.type == KB_EMITTER_THERMAL;
  const bool textured = !thermal && (emitter.ref & KB_REF_KIND_MASK) != KB_REF_SPECTRUM;
  const AreaLightSample on_light =
      sample_area_light(scene, shape, {u_triangle, selected.triangle, selected.area}, point, u, textured);
  LightSample sample;
  if (!(on_light.pdf > 0)) return sample;
  sample.direction = on_light.direction;
  sample.target = offset_ray_origin(on_light.position, on_light.normal,
                                    target_offset(on_light.offset, on_light.position - point));
  sample.pdf = on_light.pdf * selected.probability;
  sample.factor = on_light.factor;
  if (!thermal) {
    sample.radiance = radiance_of(scene, emitter.ref, on_light.uv);
    return sample;
  }
  sample.thermal = true;
  sample.on = {emitter.shape, on_light.triangle, on_light.barycentric, on_light.position};
  return sample;
}

LightSample sample_light(const FlatScene& scene, glm::vec3 point, glm::vec2 u_select, glm::vec2 u_position,
                         uint32_t facing) {
  if (scene.emitters.empty()) return {};
  const one_lane::F4 u{u_select.x, u_select.y, u_position.x, u_position.y};
  const one_lane::ChosenLight chosen = one_lane::choose_light(scene, to_lane(point), u, {true});
  if (chosen.head.type.v == KB_EMITTER_THERMAL)
    return sample_shape_light(scene,
                              {chosen.emitter.v, chosen.head.select_pdf.v, chosen.triangle.v, chosen.area.v},
                              point, u_select.y, u_position);
  const one_lane::Light light = one_lane::sample_chosen({scene}, chosen, {to_lane(point), facing}, u, {true});
  LightSample sample;
  sample.direction = to_glm(light.direction);
  sample.target = to_glm(light.target);
  sample.infinite = light.infinite.v;
  sample.delta = light.delta.v;
  sample.pdf = light.pdf.v;
  sample.factor = light.factor.v;
  sample.radiance = radiance_of(light.radiance);
  return sample;
}

SurfaceHit thermal_surface(const FlatScene& scene, const ThermalPoint& on) {
  return make_surface_hit(scene, on.shape, on.triangle, on.barycentric.x, on.barycentric.y, on.position,
                          glm::vec3(0), 0);
}

float area_light_pdf(const FlatScene& scene, const SurfaceHit& hit, glm::vec3 origin) {
  const KbShape& record = scene.shapes[hit.shape];
  if (record.emitter == KB_NONE) return 0;
  one_lane::Hit lane{};
  lane.shape = hit.shape;
  const one_lane::HitLight chosen =
      one_lane::chosen_as_light(scene, lane, record.emitter, hit.triangle, to_lane(origin), {true});
  const float probability = chosen.probability.v;
  return probability > 0 ? probability * area_light_density(record, hit, origin, chosen.area.v) : 0;
}

float environment_pdf(const FlatScene& scene, glm::vec3 direction, uint32_t facing) {
  if (scene.environment == KB_NONE) return 0;
  const one_lane::V2 uv = one_lane::environment_coordinates(scene, to_lane(direction));
  return one_lane::environment_pdf(scene, uv, facing).v;
}

float sun_pdf(const FlatScene& scene, uint32_t emitter, glm::vec3 direction) {
  const KbEmitter& sun = scene.emitters[emitter];
  return one_lane::meets_sun(sun, to_lane(direction)).v ? one_lane::sun_at(sun).pdf.v : 0;
}

EmittedRadiance environment_radiance(const FlatScene& scene, glm::vec3 direction) {
  return radiance_of(one_lane::environment_radiance(
      scene, one_lane::environment_coordinates(scene, to_lane(direction)), {true}));
}

}  // namespace kiloband::cpu
