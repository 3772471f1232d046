// Thermal emission along paths: of what is hit, and of what light is sampled from.
#include "shared/sampler.h"
#include "src_cpu/light/thermal.hpp"
#include "src_cpu/path/path_tracer.hpp"
#include "src_cpu/path/path_tracer_detail.hpp"

namespace kiloband::cpu {

/// Kirchhoff's law. What has only the ambient temperature is not sampled as a light:
/// it is found by this ray alone.
void PathTracer::add_thermal_emission(Draft& draft, const Path& path, const SurfaceHit& hit,
                                      glm::vec3 direction, const SampleId& id, uint32_t bounce) {
  const bool light = flat_.shapes[hit.shape].emitter != KB_NONE;
  if (light && bounce == 0 && flat_.integrator.hide_emitters) return;
  const KbFloat4 u = kb_thermal_sample(settings_.seed, path.key.pixel, id.sample, bounce);
  const ThermalRadiance emitted = thermal_radiance(flat_, hit, -direction, {u.x, u.y});
  if (!(emitted.weight > 0)) return;
  float weight = emitted.weight;
  if (light && !path.previous_delta) {
    weight *= power_heuristic(path.previous_pdf, area_light_pdf(flat_, hit, path.previous_point));
  }
  draft.vertex.head |= KB_VERTEX_EMIT;
  draft.vertex.emit_weight = weight;
  draft.vertex.emit_row = emitted.radiance.row;
  if (!emitted.radiance.textured) return;
  draft.vertex.head |= KB_VERTEX_TEX_EMIT;
  draft.samples[draft.sample_count++] = emitted.radiance.texture;
}

/// A light sample of this bounce; what a thermally emitting surface sends is known once its direction is.
LightSample PathTracer::choose_light(const Path& path, const SurfaceHit& hit, const SampleId& id,
                                     uint32_t bounce) const {
  const KbFloat4 u = kb_sampler_block(path.key, kb_block_light(bounce));
  LightSample light = sample_light(flat_, hit.point, {u.x, u.y}, {u.z, u.w});
  if (!light.thermal) return light;
  const KbFloat4 v = kb_thermal_sample(settings_.seed, path.key.pixel, id.sample, bounce);
  const ThermalRadiance emitted =
      thermal_radiance(flat_, thermal_surface(flat_, light.on), -light.direction, {v.z, v.w});
  light.factor *= emitted.weight;
  light.radiance = emitted.radiance;
  return light;
}

}  // namespace kiloband::cpu
