#include "src_cpu/path/path_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "shared/estimator.h"
#include "shared/sampler.h"
#include "src_cpu/geometry/texture_lookup.hpp"
#include "src_cpu/path/camera.hpp"
#include "src_cpu/path/path_tracer_detail.hpp"

namespace kiloband::cpu {
namespace {

constexpr uint32_t kWavefront = 16;  // paths that advance together

/// Multiplies `magnitude` by the vertex's scatter weight; false where a contribution could leave the range of
/// floats or is NaN already. scale: of the weights, where the vertex's spectral factor is not of order 1.
bool stays_finite(const KbPathVertex& v, float scale, float& magnitude) {
  const float emitted = v.head & KB_VERTEX_EMIT ? v.emit_weight : 0.0f;
  const uint32_t kind = v.head & KB_VERTEX_KIND_MASK;
  if (kind == KB_KIND_MEDIUM) return std::isfinite(v.nee0) && std::isfinite(v.scatter0);  // columns
  const bool two =
      kind == KB_KIND_TWO_TERM || kind == KB_KIND_NONLINEAR;  // else the second number is no weight
  const float lit = v.head & KB_VERTEX_NEE ? std::fabs(v.nee0) + (two ? std::fabs(v.nee1) : 0.0f) : 0.0f;
  const bool fits = magnitude * (emitted + scale * lit) < KB_LARGEST_WEIGHT;
  if (v.head & KB_VERTEX_SCATTER)
    magnitude *= scale * (std::fabs(v.scatter0) + (two ? std::fabs(v.scatter1) : 0.0f));
  return fits && magnitude < KB_LARGEST_WEIGHT;
}

void set_flag(KbPathVertex& vertex, uint32_t flag) {
  vertex.head |= flag;
}

}  // namespace

PathTracer::PathTracer(const TracerScene& scene, const SamplingSettings& settings)
    : scene_(scene), flat_(*scene.flat), settings_(settings) {
  constexpr std::size_t kPixels = std::size_t{kBlockSize} * kBlockSize;
  paths_.reserve(kPixels);
  entries_.reserve(8 * kPixels);
}

bool PathTracer::wants_bounce(uint32_t bounce) const {
  const int max_depth = flat_.integrator.max_depth;
  return max_depth < 0 || bounce + 1 < static_cast<uint32_t>(max_depth);
}

void PathTracer::trace(const PixelRect& block, const SampleId& id, std::span<const float> mu, PathBuffer& out,
                       std::vector<uint32_t>& invalid) {
  out.clear();
  invalid.clear();
  entries_.clear();
  if (flat_.integrator.max_depth == 0) return;
  const auto pixels = static_cast<uint32_t>(block.pixels());
  for (uint32_t first = 0; first < pixels; first += kWavefront) {
    start_paths(block, first, std::min(kWavefront, pixels - first), id);
    run_wavefront(id, mu);
    gather(out, invalid);
  }
}

void PathTracer::run_wavefront(const SampleId& id, std::span<const float> mu) {
  for (uint32_t bounce = 0; !active_.empty(); ++bounce) {
    if (bounce >= KB_MAX_VERTICES) {
      for (const uint32_t path : active_) paths_[path].invalid = true;
      return;
    }
    trace_closest(bounce == 0);
    shade_all(id, bounce, mu);
    trace_shadows();
  }
}

void PathTracer::start_paths(const PixelRect& block, uint32_t first, uint32_t count, const SampleId& id) {
  paths_.clear();
  dispersed_.clear();
  gas_.clear();
  entries_.clear();
  active_.clear();
  rays_queue_.clear();
  const uint32_t sampler =
      settings_.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  for (uint32_t i = first; i < first + count; ++i) {
    const uint32_t x = block.x0 + i % block.width;
    const uint32_t y = block.y0 + i / block.width;
    Path path{};
    path.pixel = i;
    path.key = kb_sampler_key(sampler, settings_.seed, y * flat_.camera.film_width + x, id.sample,
                              id.replicate, id.index);
    path.bound = path.magnitude = 1;
    path.previous_delta = true;
    path.channel = path.first_entry = path.last_entry = KB_NONE;
    const CameraRay ray = sample_camera_ray(flat_.camera, x, y, kb_sampler_block(path.key, KB_BLOCK_CAMERA));
    path.previous_point = ray.origin;
    paths_.push_back(path);
    if (flat_.features.dispersion) dispersed_.emplace_back().carried.fill(1);
    if (flat_.features.gas) gas_.push_back({MediumStack(flat_.camera_media), 0, ray.t_min, ray.t_max});
    active_.push_back(i - first);
    rays_queue_.emplace_back(ray.origin, ray.direction, ray.t_min, ray.t_max);
  }
}

void PathTracer::record_closest() {
  recording_->closest.insert(recording_->closest.end(), rays_queue_.begin(), rays_queue_.end());
  for (const uint32_t path : active_) recording_->closest_path.push_back(paths_[path].pixel);
}

void PathTracer::record_shadows() {
  recording_->shadow.insert(recording_->shadow.end(), shadow_rays_.begin(), shadow_rays_.end());
  recording_->shadow_path.insert(recording_->shadow_path.end(), shadow_path_.begin(), shadow_path_.end());
}

void PathTracer::trace_closest(bool coherent) {
  rays_ += rays_queue_.size();
  if (recording_) record_closest();
  scene_.embree->closest_hits(rays_queue_, coherent);
  if (recording_)
    recording_->answers.insert(recording_->answers.end(), rays_queue_.begin(), rays_queue_.end());
  if (flat_.features.gas) walk_boundaries();
}

void PathTracer::trace_shadows() {
  if (flat_.features.gas) return trace_shadows_through_gas();
  rays_ += shadow_rays_.size();
  if (recording_) record_shadows();
  scene_.embree->occlusions(shadow_rays_);
  for (std::size_t i = 0; i < shadow_rays_.size(); ++i) {
    if (shadow_rays_[i].occluded()) entries_[shadow_entry_[i]].vertex.head &= ~KB_VERTEX_NEE;
  }
}

/// Asks for the vertices of all hits before the first is shaded
/// (their indices were asked for while rays were traced).
void PathTracer::prefetch_vertices() const {
  for (const TraceRay& ray : rays_queue_) {
    if (ray.shape == KB_NONE) continue;
    const KbShape& shape = flat_.shapes[ray.shape];
    if (shape.type != KB_SHAPE_MESH) continue;
    const uint32_t* index = &flat_.triangles[3 * (std::size_t{shape.first_triangle} + ray.primitive)];
    for (int corner = 0; corner < 3; ++corner) __builtin_prefetch(&flat_.positions[index[corner]]);
  }
}

void PathTracer::shade_all(const SampleId& id, uint32_t bounce, std::span<const float> mu) {
  prefetch_vertices();
  next_active_.clear();
  next_rays_.clear();
  shadow_rays_.clear();
  shadow_entry_.clear();
  shadow_path_.clear();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    Path& path = paths_[active_[i]];
    const TraceRay& ray = rays_queue_[i];
    if (flat_.features.gas) append_gas(path, ray.shape == KB_NONE);
    if (ray.shape == KB_NONE) {
      add_escaped(path, ray, bounce);
    } else if (shade(path, ray, id, bounce, mu)) {
      next_active_.push_back(active_[i]);
    }
  }
  active_.swap(next_active_);
  std::swap(rays_queue_, next_rays_);
}

void PathTracer::add_escaped(Path& path, const TraceRay& ray, uint32_t bounce) {
  if (flat_.environment == KB_NONE || (bounce == 0 && flat_.integrator.hide_emitters)) return;
  const glm::vec3 direction = ray.direction();
  Draft draft;
  set_flag(draft.vertex, KB_VERTEX_EMIT);
  draft.vertex.emit_weight =
      path.previous_delta ? 1 : power_heuristic(path.previous_pdf, environment_pdf(flat_, direction));
  const EmittedRadiance radiance = environment_radiance(flat_, direction);
  draft.vertex.emit_row = radiance.row;
  if (radiance.textured) {
    set_flag(draft.vertex, KB_VERTEX_TEX_EMIT);
    draft.samples[draft.sample_count++] = radiance.texture;
  }
  append(path, draft);
}

void PathTracer::add_emission(Draft& draft, const Path& path, const SurfaceHit& hit, glm::vec3 direction,
                              uint32_t bounce) {
  const uint32_t emitter = flat_.shapes[hit.shape].emitter;
  if (emitter == KB_NONE) return;
  if (!on_front(hit.shading_normal, -direction)) return;
  if (bounce == 0 && flat_.integrator.hide_emitters) return;
  float weight = 1;
  if (!path.previous_delta) {
    weight = power_heuristic(path.previous_pdf, area_light_pdf(flat_, hit, path.previous_point));
  }
  set_flag(draft.vertex, KB_VERTEX_EMIT);
  draft.vertex.emit_weight = weight;
  const ResolvedSpectrum radiance = resolve_spectrum(flat_, flat_.emitters[emitter].ref, hit.uv);
  draft.vertex.emit_row = radiance.row;
  if (radiance.textured) {
    set_flag(draft.vertex, KB_VERTEX_TEX_EMIT);
    draft.samples[draft.sample_count++] = radiance.texture;
  }
}

/// Rows or texture samples of the factors S_a and S_b;
/// they stand before those of emission and light in the vertex.
void PathTracer::resolve_spectra(Draft& draft, const KbMaterial& material, const SurfaceHit& hit,
                                 bool use_b_for_a) {
  const uint32_t kind = draft.vertex.head & KB_VERTEX_KIND_MASK;
  const bool two = kind == KB_KIND_TWO_TERM || kind == KB_KIND_NONLINEAR;
  KbTextureSample front[2];
  uint32_t front_count = 0;
  const auto resolve = [&](uint32_t ref, uint16_t& row, uint32_t flag) {
    const ResolvedSpectrum spectrum = resolve_spectrum(flat_, ref, hit.uv);
    row = spectrum.row;
    if (!spectrum.textured) return;
    set_flag(draft.vertex, flag);
    front[front_count++] = spectrum.texture;
  };
  resolve(use_b_for_a ? material.ref_b : material.ref_a, draft.vertex.row_a, KB_VERTEX_TEX_A);
  if (two) resolve(material.ref_b, draft.vertex.row_b, KB_VERTEX_TEX_B);
  if (front_count == 0) return;
  std::copy_backward(draft.samples, draft.samples + draft.sample_count,
                     draft.samples + draft.sample_count + front_count);
  std::copy_n(front, front_count, draft.samples);
  draft.sample_count += front_count;
}

void PathTracer::append(Path& path, const Draft& draft) {
  ++vertices_;
  if (!stays_finite(draft.vertex, draft.scale, path.magnitude)) path.invalid = true;
  if (flat_.features.dispersion && (draft.vertex.head & KB_VERTEX_SCATTER))
    carry(dispersed(path).carried, draft.vertex, flat_.channel_bins);
  const auto index = static_cast<uint32_t>(entries_.size());
  (path.last_entry == KB_NONE ? path.first_entry : entries_[path.last_entry].next) = index;
  path.last_entry = index;
  entries_.push_back({draft.vertex, KB_NONE});
  for (uint32_t i = 0; i < draft.sample_count; i += 2) {
    Entry extension{};
    extension.next = KB_NONE;
    std::memcpy(&extension.vertex, &draft.samples[i],
                std::min(draft.sample_count - i, 2u) * sizeof(KbTextureSample));
    entries_.push_back(extension);  // directly behind its vertex; not linked
  }
}

/// Copies the linked vertices of every path to one contiguous run, without what cannot contribute: everything
/// behind the last vertex that has light.
void PathTracer::gather(PathBuffer& out, std::vector<uint32_t>& invalid) {
  for (const Path& path : paths_) {
    if (path.invalid) {
      invalid.push_back(path.pixel);
      continue;
    }
    uint32_t last_lit = KB_NONE;
    for (uint32_t s = path.first_entry; s != KB_NONE; s = entries_[s].next) {
      if (entries_[s].vertex.head & (KB_VERTEX_EMIT | KB_VERTEX_NEE)) last_lit = s;
    }
    if (last_lit == KB_NONE) continue;
    const auto first = static_cast<uint32_t>(out.entries.size());
    for (uint32_t s = path.first_entry;; s = entries_[s].next) {
      KbPathVertex vertex = entries_[s].vertex;
      if (!(vertex.head & KB_VERTEX_NEE))
        vertex.head &= ~KB_VERTEX_TEX_NEE;  // its sample comes last: drop it
      if (s == last_lit) vertex.head &= ~(KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
      out.entries.push_back(vertex);
      for (uint32_t i = 0; i < kb_vertex_extensions(vertex.head); ++i)
        out.entries.push_back(entries_[s + 1 + i].vertex);
      if (s == last_lit) break;
    }
    out.paths.push_back({first, static_cast<uint32_t>(out.entries.size()) - first, path.pixel});
  }
}

}  // namespace kiloband::cpu
