// Boundaries whose index depends on wavelength: degradation to one channel, spectral MIS for all.
#include <algorithm>
#include <cmath>

#include "shared/sampler.h"
#include "src_cpu/geometry/texture_lookup.hpp"
#include "src_cpu/path/path_tracer.hpp"
#include "src_cpu/path/path_tracer_detail.hpp"

namespace kiloband::cpu {

/// Index of the interior over the exterior at the chosen channel's wavelength.
float PathTracer::channel_eta(const KbMaterial& material, uint32_t channel, float mu) const {
  const Channel& c = flat_.channels[channel];
  const double lambda_nm = (1.0 - mu) * c.min_nm + mu * c.max_nm;
  const double exterior =
      material.ext_row == KB_NONE ? material.eta_ext : flat_.spectra[material.ext_row].table(lambda_nm);
  return static_cast<float>(flat_.spectra[material.eta_row].table(lambda_nm) / exterior);
}

/// One channel is what the path stands for from here on. carried: what each still carries.
/// Returns its probability.
float PathTracer::survive(Path& path, const BinnedThroughput& carried, const SampleId& id, uint32_t bounce) {
  const float u = kb_degrade_sample(settings_.seed, path.key.pixel, id.sample, bounce);
  const ChannelChoice choice = choose_channel(carried, static_cast<uint32_t>(flat_.channels.size()), u);
  path.channel = choice.channel;
  return choice.probability;
}

/// Refraction by an index that depends on wavelength: one channel goes on, with weight 1 / probability.
bool PathTracer::refract_one_channel(Draft& draft, Path& path, const KbMaterial& material, glm::vec3 wi,
                                     BsdfSample& sample, const SampleId& id, uint32_t bounce, float mu) {
  BinnedThroughput carried = dispersed(path).carried;
  if ((material.ref_b & KB_REF_KIND_MASK) == KB_REF_SPECTRUM) {
    for (uint32_t b = 0; b < KB_CHANNEL_BINS; ++b)
      carried[b] *= flat_.channel_bins[std::size_t{material.ref_b} * KB_CHANNEL_BINS + b];
  }
  const float probability = survive(path, carried, id, bounce);
  sample =
      transmit_dispersive(material, wi, channel_eta(material, path.channel, mu), sample.pdf * probability);
  sample.needs_channel = true;
  if (!(sample.pdf > 0)) return false;
  // Roulette follows the one channel that is left: its weight stands for all channels' chances, and is no
  // gain as far as it is the mean one, K.
  sample.bound /= static_cast<float>(flat_.channels.size());
  draft.vertex.head |= KB_VERTEX_DEGRADE;
  draft.vertex.scatter1 = kb_as_f32(path.channel);
  return true;
}

/// A rough dispersive boundary: the channel is chosen on arrival, before light and BSDF samples.
void PathTracer::degrade(Path& path, const SampleId& id, uint32_t bounce) {
  const float probability = survive(path, dispersed(path).carried, id, bounce);
  Draft draft;
  draft.vertex.head = KB_KIND_SCALED | KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE;
  draft.vertex.row_a = static_cast<uint16_t>(flat_.unit_row);
  draft.vertex.scatter0 = 1 / probability;
  draft.vertex.scatter1 = kb_as_f32(path.channel);
  path.bound /= probability * static_cast<float>(flat_.channels.size());
  append(path, draft);
}

/// The path's hero channels at this boundary. count 0: there are none, since a lobe is too narrow for float
/// directions and the boundary is treated as a smooth one, or the boundary is energy-compensated (surfaces
/// that emit thermally), by a factor that depends on the index.
HeroSet PathTracer::choose_heroes(const Path& path, const KbMaterial& material, const SampleId& id,
                                  float mu) {
  if (material.flags & KB_MATERIAL_COMPENSATED) return {};
  const auto channels = static_cast<uint32_t>(flat_.channels.size());
  HeroSet heroes;
  heroes.count = std::min(KB_MAX_HEROES, channels);
  DispersedPath& own = dispersed(path);
  if (own.heroes == 0) {
    own.heroes = heroes.count;
    own.hero_weights.fill(1.0f / static_cast<float>(heroes.count));
  }
  heroes.q = own.hero_weights;
  const float offset = kb_hero_offset(settings_.seed, path.key.pixel, id.sample);
  for (uint32_t c = 0; c < heroes.count; ++c) {
    heroes.eta[c] = channel_eta(material, hero_channel(c, heroes.count, channels, offset), mu);
    if (acts_smooth(material, heroes.eta[c]) || acts_smooth(material, 1 / heroes.eta[c])) return {};
  }
  return heroes;
}

/// Appends a vertex whose weight (nee0 or scatter0) is set, with the spectra and directions of its pair.
void PathTracer::append_pair(Path& path, Draft& draft, const Boundary& at, const BoundaryPair& pair,
                             glm::vec3 wo) {
  KbPathVertex& v = draft.vertex;
  const bool nee = v.head & KB_VERTEX_NEE;
  v.head |= at.side << KB_VERTEX_MATERIAL_SHIFT |
            (pair.transmission ? KB_KIND_ROUGH_TRANSMISSION : KB_KIND_DISPERSIVE);
  if (pair.transmission) {
    v.emit_weight = at.wi.x;
    (nee ? v.scatter0 : v.nee0) = at.wi.y;
    v.nee1 = wo.x;
    v.scatter1 = wo.y;
    v.row_b = at.wi.z < 0;
  } else {
    (nee ? v.nee1 : v.scatter1) = pair.cosine;
  }
  resolve_spectra(draft, at.material, at.hit, pair.transmission);
  append(path, draft);
}

/// Next-event estimation at a rough dispersive boundary: a vertex of its own.
/// Returns whether a shadow ray was queued.
bool PathTracer::add_hero_light(Path& path, const Boundary& at, const HeroSet& heroes, const SampleId& id,
                                uint32_t bounce) {
  if (flat_.emitters.empty()) return false;
  const LightSample light = choose_light(path, at.hit, id, bounce);
  if (!(light.pdf > 0) || !(light.factor > 0)) return false;
  const glm::vec3 wo = at.frame.to_local(light.direction);
  const BoundaryPair pair = rough_boundary_pair(at.material, at.wi, wo);
  const HeroDensity density = hero_density(at.material, heroes, at.wi, wo);
  const float mis = light.delta ? 1 : power_heuristic(light.pdf, density.pdf * at.opacity);
  const float weight = mis * at.opacity * light.factor / light.pdf * pair.weight;
  if (!(weight > 0)) return false;
  Draft draft;
  draft.vertex.head = KB_VERTEX_NEE;
  draft.vertex.nee0 = weight;
  draft.vertex.nee_row = light.radiance.row;
  draft.scale = density.value / pair.weight;
  if (light.radiance.textured) {
    draft.vertex.head |= KB_VERTEX_TEX_NEE;
    draft.samples[draft.sample_count++] = light.radiance.texture;
  }
  append_pair(path, draft, at, pair, wo);
  queue_shadow_ray(at.hit, light);
  if (flat_.features.gas) note_shadow(path, at.hit, at.direction);
  shadow_entry_.push_back(path.last_entry);
  if (recording_) shadow_path_.push_back(path.pixel);
  return true;
}

/// Samples a direction for all channels. Returns whether the path goes on.
bool PathTracer::scatter_heroes(Path& path, const Boundary& at, const HeroSet& heroes, const KbFloat4& u,
                                const SampleId& id, uint32_t bounce) {
  const KbFloat4 h = kb_hero_sample(settings_.seed, path.key.pixel, id.sample, bounce);
  const glm::vec3 wo = sample_heroes(at.material, heroes, at.wi, {h.x, h.y}, u.x, {u.y, u.z});
  const BoundaryPair pair = rough_boundary_pair(at.material, at.wi, wo);
  const HeroDensity density = hero_density(at.material, heroes, at.wi, wo);
  if (!(density.pdf > 0) || !(pair.weight > 0)) return false;
  Draft draft;
  draft.vertex.head = KB_VERTEX_SCATTER;
  draft.vertex.scatter0 = pair.weight / density.pdf;
  draft.scale = density.value / pair.weight;
  // Channels between the heroes may carry a little more, or all where no hero has anything: never below
  // delta, so that roulette does not stop them all.
  path.bound *= std::max(density.bound / density.pdf, KB_NO_HERO) *
                (pair.transmission ? at.material.bound_b : at.material.bound_a);
  if (!(path.bound > 0)) return false;
  for (uint32_t c = 0; c < heroes.count; ++c)
    dispersed(path).hero_weights[c] = heroes.q[c] * density.hero[c] / density.pdf;
  if (!roulette(draft, path, bounce, u.w)) return false;
  append_pair(path, draft, at, pair, wo);
  path.previous_pdf = density.pdf * at.opacity;
  path.previous_delta = false;
  continue_ray(at.hit, at.frame.to_world(wo));
  path.previous_point = at.hit.point;
  return true;
}

}  // namespace kiloband::cpu
