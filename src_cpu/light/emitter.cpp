#include "src_cpu/light/emitter.hpp"

#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "src_cpu/light/area.hpp"

namespace kiloband::cpu {

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
    sample.radiance = resolve_spectrum(scene, emitter.ref, on_light.uv);
    return sample;
  }
  sample.thermal = true;
  sample.on = {emitter.shape, on_light.triangle, on_light.barycentric, on_light.position};
  return sample;
}

}  // namespace kiloband::cpu
