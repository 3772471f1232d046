// One bounce of one path: emission, next-event estimation, scattering, degradation, roulette.
#include <algorithm>
#include <cmath>

#include "shared/estimator.h"
#include "shared/material_tables.h"
#include "shared/sampler.h"
#include "src_cpu/geometry/boundary.hpp"
#include "src_cpu/geometry/texture_lookup.hpp"
#include "src_cpu/path/path_tracer.hpp"
#include "src_cpu/path/path_tracer_detail.hpp"

namespace kiloband::cpu {
namespace {

bool is_black(const KbMaterial& material) {
  return material.bound_a == 0 && material.bound_b == 0;
}

bool is_rough_dispersive(const KbMaterial& material) {
  return material.type == KB_MATERIAL_ROUGH_DIELECTRIC && (material.flags & KB_MATERIAL_DISPERSIVE);
}

}  // namespace

/// A textured material with the bounds of this very point (in `local`); the bounds of the whole image would
/// keep paths alive for ever where one texel is white.
const KbMaterial& PathTracer::with_local_bounds(const KbMaterial& material, const SurfaceHit& hit,
                                                KbMaterial& local) const {
  const auto is_textured = [](uint32_t ref) {
    return ref != KB_NONE && (ref & KB_REF_KIND_MASK) != KB_REF_SPECTRUM;
  };
  const bool a = is_textured(material.ref_a), b = is_textured(material.ref_b);
  if (!a && !b) return material;
  local = material;
  if (a) local.bound_a = spectrum_bound(flat_, resolve_spectrum(flat_, material.ref_a, hit.uv));
  if (b) local.bound_b = spectrum_bound(flat_, resolve_spectrum(flat_, material.ref_b, hit.uv));
  return local;
}

bool PathTracer::shade(Path& path, const TraceRay& ray, const SampleId& id, uint32_t bounce,
                       std::span<const float> mu) {
  const glm::vec3 direction = ray.direction();
  const SurfaceHit hit =
      make_surface_hit(flat_, ray.shape, ray.primitive, ray.u, ray.v, ray.origin(), direction, ray.t_max);
  Draft draft;
  const uint32_t outermost = flat_.shapes[hit.shape].surface;
  if (flat_.surfaces[outermost].flags & KB_SURFACE_THERMAL) {
    add_thermal_emission(draft, path, hit, direction, id, bounce);
  } else {
    add_emission(draft, path, hit, direction, bounce);
  }
  const auto finish = [&](bool goes_on) {
    if (draft.vertex.head & (KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER)) append(path, draft);
    return goes_on;
  };
  if (!wants_bounce(bounce)) return finish(false);

  KbFloat4 u = kb_sampler_block(path.key, kb_block_bsdf(bounce));
  const KbSurface& surface = chosen_surface(flat_, outermost, hit.uv, u.x);
  const float opacity = opacity_at(flat_, surface, hit.uv);
  const bool passes = opacity < 1 && u.x >= opacity;
  if (opacity < 1)
    u.x = std::min(passes ? (u.x - opacity) / (1 - opacity) : u.x / opacity, KB_ONE_MINUS_EPSILON);

  ShadingFrame frame(hit.shading_normal, glm::vec3(0));
  glm::vec3 wi = frame.to_local(-direction);
  uint32_t side = surface.front;
  const bool below = wi.z < 0;
  if (below && (surface.flags & KB_SURFACE_TWO_SIDED)) side = surface.back;
  const bool black_back = below && !(surface.flags & (KB_SURFACE_TWO_SIDED | KB_SURFACE_TRANSMISSIVE));
  KbMaterial local;
  const KbMaterial& record = with_local_bounds(flat_.materials[side], hit, local);
  if (black_back || is_black(record)) {
    if (!passes) return finish(false);
    finish(true);
    pass_through(path, hit, direction);
    if (flat_.features.gas) follow_gas(path, hit, direction);
    return true;
  }
  if (record.alpha_u != record.alpha_v) frame = ShadingFrame(hit.shading_normal, hit.tangent);
  if (below && (surface.flags & KB_SURFACE_TWO_SIDED)) {
    frame.y = -frame.y;  // the frame seen from behind stays right-handed
    frame.z = -frame.z;
  }
  wi = frame.to_local(-direction);

  MaterialContext material{&record, record.table == KB_NONE ? nullptr : &flat_.tables[record.table], {}};
  if (record.flags & KB_MATERIAL_COMPENSATED) {
    material.compensation = material.table + kb_floats_before_compensation(record.type, record.flags);
    // A metal's compensation has two parts, a and a F0: one of them is taken,
    // for light and BSDF sample alike.
    if (eval_kind(record) == KB_KIND_CONDUCTOR && u.x >= lobe_albedo(material, wi)) {
      if (&record != &local) local = record;
      local.ref_a = record.ref_b;
      local.bound_a = record.bound_b;
      material.material = &local;
    }
  }
  if (record.flags & KB_MATERIAL_DISPERSIVE) {
    const float offset = mu[mu.size() == 1 ? 0 : path.pixel];
    if (is_rough_dispersive(record) && path.channel == KB_NONE) {
      finish(true);
      draft = Draft{};
      const HeroSet heroes = settings_.rough_dispersion == RoughDispersion::kSpectralMis
                                 ? choose_heroes(path, record, id, offset)
                                 : HeroSet{};
      if (heroes.count > 0) {
        const Boundary at{hit, frame, record, side, wi, opacity, direction};
        add_hero_light(path, at, heroes, id, bounce);
        const bool goes_on = passes || scatter_heroes(path, at, heroes, u, id, bounce);
        if (passes) pass_through(path, hit, direction);
        if (goes_on && flat_.features.gas) follow_gas(path, hit, direction);
        return goes_on;
      }
      degrade(path, id, bounce);
    }
    if (path.channel != KB_NONE) material.dispersion.eta = channel_eta(record, path.channel, offset);
  }
  draft.vertex.head |= eval_kind(record) | side << KB_VERTEX_MATERIAL_SHIFT;
  const bool lit =
      has_smooth_lobe(record) && add_light_sample(draft, path, hit, frame, material, wi, opacity, id, bounce);
  if (lit && flat_.features.gas) note_shadow(path, hit, direction);
  bool goes_on = false;
  if (passes) {
    if (draft.vertex.head & KB_VERTEX_NEE) resolve_spectra(draft, *material.material, hit, false);
    pass_through(path, hit, direction);
    goes_on = true;
  } else {
    goes_on = scatter(draft, path, hit, frame, material, wi, u, opacity, id, bounce,
                      mu[mu.size() == 1 ? 0 : path.pixel]);
  }
  if (goes_on && flat_.features.gas) follow_gas(path, hit, direction);
  finish(goes_on);
  if (lit) shadow_entry_.push_back(path.last_entry);
  if (lit && recording_) shadow_path_.push_back(path.pixel);
  return goes_on;
}

/// A mask's transparent part: the ray goes on as if nothing were there. Shadow rays stop at masks, so what
/// lies behind is found by this ray alone and gets weight 1.
void PathTracer::pass_through(Path& path, const SurfaceHit& hit, glm::vec3 direction) {
  path.previous_delta = true;
  path.previous_pdf = 0;
  continue_ray(hit, direction);
  path.previous_point = hit.point;
}

void PathTracer::continue_ray(const SurfaceHit& hit, glm::vec3 direction) {
  next_rays_.emplace_back(leave_surface(hit, direction), direction, 0.0f, kInfiniteDistance);
}

/// Next-event estimation: queues a shadow ray and stores the weights as if it were visible. The shadow ray's
/// vertex is noted by the caller once the vertex is appended. Returns whether a ray was queued.
bool PathTracer::add_light_sample(Draft& draft, Path& path, const SurfaceHit& hit, const ShadingFrame& frame,
                                  const MaterialContext& material, glm::vec3 wi, float opacity,
                                  const SampleId& id, uint32_t bounce) {
  if (flat_.emitters.empty()) return false;
  const LightSample light = choose_light(path, hit, id, bounce);
  if (!(light.pdf > 0) || !(light.factor > 0)) return false;
  const BsdfValue value = eval_bsdf(material, wi, frame.to_local(light.direction));
  if (value.w0 < KB_LEAST_BSDF_VALUE && value.w1 < KB_LEAST_BSDF_VALUE) return false;
  const bool conductor = (draft.vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_CONDUCTOR;
  const float mis = light.delta ? 1 : power_heuristic(light.pdf, value.pdf * opacity);
  const float weight = mis * opacity * light.factor / light.pdf;
  if (weight == 0) return false;
  // A rough dielectric reflects with S_a and transmits with S_b: as two terms, one vertex carries both.
  if (material.material->type == KB_MATERIAL_ROUGH_DIELECTRIC) {
    draft.vertex.head = (draft.vertex.head & ~KB_VERTEX_KIND_MASK) | KB_KIND_TWO_TERM;
    (value.lobe_b ? draft.vertex.nee1 : draft.vertex.nee0) = weight * value.w0;
  } else {
    draft.vertex.nee0 = weight * value.w0;
    draft.vertex.nee1 = conductor ? value.w1 : weight * value.w1;
  }
  draft.vertex.head |= KB_VERTEX_NEE;
  draft.vertex.nee_row = light.radiance.row;
  if (light.radiance.textured) {
    draft.vertex.head |= KB_VERTEX_TEX_NEE;
    draft.samples[draft.sample_count++] = light.radiance.texture;
  }
  queue_shadow_ray(hit, light);
  return true;
}

void PathTracer::queue_shadow_ray(const SurfaceHit& hit, const LightSample& light) {
  const glm::vec3 origin = leave_surface(hit, light.direction);
  if (light.infinite) {
    shadow_rays_.emplace_back(origin, light.direction, kInfiniteDistance);
  } else {
    shadow_rays_.emplace_back(origin, light.target - origin, 1.0f);
  }
}

bool PathTracer::scatter(Draft& draft, Path& path, const SurfaceHit& hit, const ShadingFrame& frame,
                         MaterialContext& material, glm::vec3 wi, const KbFloat4& u, float opacity,
                         const SampleId& id, uint32_t bounce, float mu) {
  const KbMaterial& record = *material.material;
  BsdfSample sample = sample_bsdf(material, wi, u.x, {u.y, u.z});
  if (sample.kind == KB_KIND_CONDUCTOR) sample.bound *= kb_conductor_bound(material.table, sample.w1);
  const bool has_light = draft.vertex.head & KB_VERTEX_NEE;
  bool use_b = sample.lobe_b;
  if (sample.needs_channel && !refract_one_channel(draft, path, record, wi, sample, id, bounce, mu))
    sample.pdf = 0;
  if (sample.needs_channel) use_b = true;
  const bool alive = sample.pdf > 0 && sample.bound > 0;
  if (alive) {
    draft.vertex.head |= KB_VERTEX_SCATTER;
    if (record.type == KB_MATERIAL_ROUGH_DIELECTRIC &&
        (has_light || (draft.vertex.head & KB_VERTEX_KIND_MASK) == KB_KIND_TWO_TERM)) {
      draft.vertex.head = (draft.vertex.head & ~KB_VERTEX_KIND_MASK) | KB_KIND_TWO_TERM;
      draft.vertex.scatter0 = sample.lobe_b ? 0 : sample.w0;
      draft.vertex.scatter1 = sample.lobe_b ? sample.w0 : 0;
      use_b = false;
    } else {
      draft.vertex.head = (draft.vertex.head & ~KB_VERTEX_KIND_MASK) | sample.kind;
      draft.vertex.scatter0 = sample.w0;
      if (!sample.needs_channel) draft.vertex.scatter1 = sample.w1;
    }
    path.bound *= sample.bound;
    path.previous_pdf = sample.pdf * opacity;
    path.previous_delta = sample.delta;
  }
  if (!alive) {
    if (has_light) resolve_spectra(draft, record, hit, false);
    return false;
  }
  const bool survives = roulette(draft, path, bounce, u.w);
  if (survives || has_light) resolve_spectra(draft, record, hit, use_b);
  if (!survives) return false;
  glm::vec3 direction = frame.to_world(sample.wo);
  if (sample.delta) direction = glm::normalize(direction);  // rounding would add up along specular chains
  continue_ray(hit, direction);
  path.previous_point = hit.point;
  return true;
}

/// Survival q = min(1, bound): never below what any channel still carries,
/// so no channel's variance becomes infinite.
bool PathTracer::roulette(Draft& draft, Path& path, uint32_t bounce, float u) {
  if (bounce + 1 < static_cast<uint32_t>(flat_.integrator.rr_depth)) return true;
  const float q = std::min(1.0f, path.bound);
  if (u >= q) {
    draft.vertex.head &= ~(KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
    return false;
  }
  draft.vertex.scatter0 /= q;
  const uint32_t kind = draft.vertex.head & KB_VERTEX_KIND_MASK;
  if (kind == KB_KIND_TWO_TERM || kind == KB_KIND_NONLINEAR) draft.vertex.scatter1 /= q;
  path.bound /= q;
  return true;
}

}  // namespace kiloband::cpu
