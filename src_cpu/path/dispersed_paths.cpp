#include "src_cpu/path/dispersed_paths.hpp"

#include <algorithm>
#include <cmath>

#include "shared/sampler.h"
#include "src_cpu/path/thermal-inl.hpp"

namespace kiloband::cpu::one_lane {
namespace {

/// The material that is seen, with the bounds of this very point.
KbMaterial material_of(const Shading& s) {
  KbMaterial material = s.scene().materials[s.side.v];
  material.bound_a = s.material.bound_a.v;
  material.bound_b = s.material.bound_b.v;
  return material;
}

/// C of spectral_mis.hpp.
uint32_t hero_count(const FlatScene& scene) {
  return std::min(KB_MAX_HEROES, static_cast<uint32_t>(scene.channels.size()));
}

bool is_rough(const KbMaterial& material) {
  return material.type == KB_MATERIAL_ROUGH_DIELECTRIC;
}

bool is_dispersive(const FlatScene& scene, uint32_t material) {
  return material != KB_NONE && (scene.materials[material].flags & KB_MATERIAL_DISPERSIVE);
}

/// Whether a surface, or one of those that it blends, has a dispersive side.
bool may_disperse(const FlatScene& scene, const KbSurface& surface) {
  if (surface.flags & KB_SURFACE_BLEND)
    return may_disperse(scene, scene.surfaces[surface.first]) ||
           may_disperse(scene, scene.surfaces[surface.second]);
  return is_dispersive(scene, surface.front) || is_dispersive(scene, surface.back);
}

BoundaryPair pair_of(const Shading& s, glm::vec3 wo) {
  if (s.wi.z.v == 0 || wo.z == 0) return {F(0), F(0), {false}};
  return rough_boundary_pair(s.material, s.wi, to_lane(wo), {true});
}

}  // namespace

DispersedPaths::DispersedPaths(const FlatScene& scene, EvalHeroes eval_heroes)
    : scene_(scene), eval_heroes_(eval_heroes) {
  std::vector<uint32_t> surfaces;
  for (const KbSurface& surface : scene.surfaces) surfaces.push_back(may_disperse(scene, surface));
  for (const KbShape& shape : scene.shapes) shapes_.push_back(surfaces[shape.surface]);
}

void DispersedPaths::start(std::span<const float> mu) {
  mu_ = mu;
  std::array<float, KB_MAX_HEROES> even;
  even.fill(1.0f / static_cast<float>(hero_count(scene_)));
  hero_weights_.assign(kWavePaths, even);
}

bool DispersedPaths::shade(Shading& s) {
  if (!is_dispersive(scene_, s.side.v)) return false;
  const KbMaterial material = material_of(s);
  PathState& path = s.wave.paths[s.path.v];
  if (is_rough(material) && path.channel == KB_NONE) {
    append(s.wave, s.path, s.vertex, s.vertex.has(KB_VERTEX_EMIT));
    s.vertex.head = U(0u);
    const HeroSet heroes = s.bounce.settings.rough_dispersion == RoughDispersion::kSpectralMis
                               ? choose_heroes(s, material)
                               : HeroSet{};
    if (heroes.count > 0) {
      const Boundary at{material, to_glm(s.wi)};
      add_hero_light(s, at, heroes);
      if (s.passes.v)
        continue_paths(s, s.direction, F(path.bound), F(0), {true}, {true});
      else
        scatter_heroes(s, at, heroes);
      return true;
    }
    degrade(s);
  }
  if (path.channel != KB_NONE) s.material.channel_eta = channel_eta(material, path.channel, mu_of(path));
  return false;
}

/// Index of the interior over the exterior at the chosen channel's wavelength.
float DispersedPaths::channel_eta(const KbMaterial& material, uint32_t channel, float mu) const {
  const Channel& c = scene_.channels[channel];
  const double lambda_nm = (1.0 - mu) * c.min_nm + mu * c.max_nm;
  const double exterior =
      material.ext_row == KB_NONE ? material.eta_ext : scene_.spectra[material.ext_row].table(lambda_nm);
  return static_cast<float>(scene_.spectra[material.eta_row].table(lambda_nm) / exterior);
}

/// What each channel still carries, by bins: the product of the scatter weights that the path has saved.
BinnedThroughput DispersedPaths::carried(const Shading& s) const {
  BinnedThroughput product;
  product.fill(1);
  const std::vector<WaveEntry>& entries = s.wave.entries;
  for (uint32_t e = s.wave.paths[s.path.v].first_entry; e != KB_NONE; e = entries[e].next)
    if (entries[e].vertex.head & KB_VERTEX_SCATTER) carry(product, entries[e].vertex, scene_.channel_bins);
  return product;
}

/// One channel is what the path stands for from here on. carried: what each still carries.
/// Returns its probability.
float DispersedPaths::survive(const Shading& s, const BinnedThroughput& carried) {
  PathState& path = s.wave.paths[s.path.v];
  const float u =
      kb_degrade_sample(s.bounce.settings.seed, path.film_pixel, s.bounce.id.sample, s.bounce.number);
  const ChannelChoice choice = choose_channel(carried, static_cast<uint32_t>(scene_.channels.size()), u);
  path.channel = choice.channel;
  return choice.probability;
}

void DispersedPaths::refract_one_channel(Shading& s, BsdfSample& sample) {
  const PathState& path = s.wave.paths[s.path.v];
  const KbMaterial material = material_of(s);
  BinnedThroughput carries = carried(s);
  if ((material.ref_b & KB_REF_KIND_MASK) == KB_REF_SPECTRUM) {
    for (uint32_t b = 0; b < KB_CHANNEL_BINS; ++b)
      carries[b] *= scene_.channel_bins[std::size_t{material.ref_b} * KB_CHANNEL_BINS + b];
  }
  const float probability = survive(s, carries);
  const float eta = channel_eta(material, path.channel, mu_of(path));
  sample = transmit_dispersive(s.material, s.wi, F(eta), sample.pdf * F(probability), {true});
  // Roulette follows the one channel that is left: its weight stands for all channels' chances, and is no
  // gain as far as it is the mean one, K.
  sample.bound = sample.bound / F(static_cast<float>(scene_.channels.size()));
  sample.w1 = F(kb_channel_weight(path.channel));
  s.vertex.set(sample.pdf > F(0), KB_VERTEX_DEGRADE);
}

/// A rough dispersive boundary: the channel is chosen on arrival, before light and BSDF samples.
void DispersedPaths::degrade(Shading& s) {
  PathState& path = s.wave.paths[s.path.v];
  const float probability = survive(s, carried(s));
  Vertex v = empty_vertex();
  v.head = U(KB_KIND_SCALED | KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
  v.a.row = U(scene_.unit_row);
  v.scatter0 = 1 / probability;
  v.scatter1 = kb_channel_weight(path.channel);
  path.bound /= probability * static_cast<float>(scene_.channels.size());
  append(s.wave, s.path, v, {true});
}

/// The path's hero channels at this boundary. count 0: there are none, since a lobe is too narrow for float
/// directions and the boundary is treated as a smooth one, or the boundary is energy-compensated (surfaces
/// that emit thermally), by a factor that depends on the index.
HeroSet DispersedPaths::choose_heroes(const Shading& s, const KbMaterial& material) {
  if (material.flags & KB_MATERIAL_COMPENSATED) return {};
  const auto channels = static_cast<uint32_t>(scene_.channels.size());
  HeroSet heroes;
  heroes.count = hero_count(scene_);
  const PathState& path = s.wave.paths[s.path.v];
  heroes.q = hero_weights_[s.path.v];
  const float offset = kb_hero_offset(s.bounce.settings.seed, path.film_pixel, s.bounce.id.sample);
  for (uint32_t c = 0; c < heroes.count; ++c)
    heroes.eta[c] = channel_eta(material, hero_channel(c, heroes.count, channels, offset), mu_of(path));
  const Facets facets = facets_of(s.material);
  for (uint32_t c = 0; c < heroes.count; ++c)
    if (any(acts_smooth(facets, F(heroes.eta[c])) | acts_smooth(facets, F(1 / heroes.eta[c])))) return {};
  return heroes;
}

/// Saves a vertex whose weight (nee0 or scatter0) is set, with the spectra and directions of its pair.
void DispersedPaths::append_pair(Shading& s, const Boundary& at, const BoundaryPair& pair, glm::vec3 wo,
                                 Vertex v) {
  const bool light = v.has(KB_VERTEX_NEE).v;
  v.head = v.head | U(s.side.v << KB_VERTEX_MATERIAL_SHIFT |
                      (pair.transmission.v ? KB_KIND_ROUGH_TRANSMISSION : KB_KIND_DISPERSIVE));
  v.a = s.vertex.a;
  v.b = s.vertex.b;
  finish_spectra(v, {true}, pair.transmission);
  if (pair.transmission.v) {
    v.emit_weight = at.wi.x;
    (light ? v.scatter0 : v.nee0) = at.wi.y;
    v.nee1 = wo.x;
    v.scatter1 = wo.y;
    v.b.row = U(at.wi.z < 0 ? 1u : 0u);
  } else {
    (light ? v.nee1 : v.scatter1) = pair.cosine;
  }
  append(s.wave, s.path, v, {true});
}

/// Next-event estimation at a rough dispersive boundary: a vertex of its own.
void DispersedPaths::add_hero_light(Shading& s, const Boundary& at, const HeroSet& heroes) {
  if (scene_.emitters.empty()) return;
  const Light light = sample_lights(s, {true});
  if (!(light.pdf.v > 0) || !(light.factor.v > 0)) return;
  const glm::vec3 wo = to_glm(s.frame.to_local(light.direction));
  const BoundaryPair pair = pair_of(s, wo);
  const HeroDensity density = hero_density(eval_heroes_, at.material, heroes, at.wi, wo);
  const float opacity = s.opacity.v;
  const float mis = light.delta.v ? 1 : power_heuristic(light.pdf, F(density.pdf * opacity)).v;
  const float share = scene_.features.bump ? bump_share(s, light.direction).v : 1;
  const float weight = mis * opacity * light.factor.v / light.pdf.v * pair.weight.v * share;
  if (!(weight > 0)) return;
  Vertex v = empty_vertex();
  v.head = U(KB_VERTEX_NEE | (light.radiance.textured.v ? KB_VERTEX_TEX_NEE : 0u));
  v.nee0 = weight;
  v.light = light.radiance;
  v.scale = density.value / pair.weight.v;
  append_pair(s, at, pair, wo, v);
  queue_shadow_rays(s, light, {true});
  note_shadow_rays(s.wave, {true});
}

/// Samples a direction for all channels.
void DispersedPaths::scatter_heroes(Shading& s, const Boundary& at, const HeroSet& heroes) {
  const PathState& path = s.wave.paths[s.path.v];
  const KbFloat4 h =
      kb_hero_sample(s.bounce.settings.seed, path.film_pixel, s.bounce.id.sample, s.bounce.number);
  const glm::vec3 wo = sample_heroes(at.material, heroes, at.wi, {h.x, h.y}, s.u.x.v, {s.u.y.v, s.u.z.v});
  const BoundaryPair pair = pair_of(s, wo);
  const HeroDensity density = hero_density(eval_heroes_, at.material, heroes, at.wi, wo);
  const V3 direction = s.frame.to_world(to_lane(wo));
  const float share = scene_.features.bump ? bump_share(s, direction).v : 1;
  if (!(density.pdf > 0) || !(pair.weight.v > 0) || !(share > 0)) return;
  // Channels between the heroes may carry a little more, or all where no hero has anything: never below
  // delta, so that roulette does not stop them all.
  F bound = path.bound * (std::max(density.bound / density.pdf, KB_NO_HERO) *
                          (pair.transmission.v ? at.material.bound_b : at.material.bound_a));
  if (!(bound.v > 0)) return;
  for (uint32_t c = 0; c < heroes.count; ++c)
    hero_weights_[s.path.v][c] = heroes.q[c] * density.hero[c] / density.pdf;
  s.vertex.head = U(KB_VERTEX_SCATTER);
  s.vertex.emit_weight = s.vertex.nee0 = s.vertex.nee1 = s.vertex.scatter1 = F(0);
  s.vertex.scatter0 = F(pair.weight.v / density.pdf * share);
  s.vertex.scale = F(density.value / pair.weight.v);
  if (!roulette(s, bound, {true}).v) return;
  append_pair(s, at, pair, wo, s.vertex);
  continue_paths(s, direction, bound, F(density.pdf * s.opacity.v), {false}, {true});
}

}  // namespace kiloband::cpu::one_lane
