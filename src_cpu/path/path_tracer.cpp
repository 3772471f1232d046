#include "src_cpu/path/path_tracer.hpp"

#include "shared/estimator.h"
#include "src_cpu/path/dispersed_paths.hpp"

namespace kiloband::cpu {
namespace {

/// 512 KiB: about as much as the second-level cache has for them.
constexpr std::size_t kMostCachedRecords = 8192;

/// use(i): for rays whose paths have a pixel; the others are traced for their neighbours' sake alone.
template <class Queue, class Use>
void for_recorded(const Wave& wave, const Queue& rays, const Use& use) {
  for (uint32_t i = 0; i < rays.count; ++i)
    if (wave.paths[rays.path[i]].pixel != KB_NONE) use(i);
}

void record_closest(const Wave& wave, const RayQueue& rays) {
  for_recorded(wave, rays, [&](uint32_t i) {
    wave.recording->closest.push_back(query_of(rays, i));
    wave.recording->closest_path.push_back(wave.paths[rays.path[i]].pixel);
  });
  wave.recording->closest_ends.push_back(wave.recording->closest.size());
}

void record_answers(const Wave& wave, const RayQueue& rays) {
  for_recorded(wave, rays, [&](uint32_t i) { wave.recording->answers.push_back(ray_of(rays, i)); });
}

void record_shadows(const Wave& wave, const ShadowQueue& rays) {
  for_recorded(wave, rays, [&](uint32_t i) {
    wave.recording->shadow.push_back(query_of(rays, i));
    wave.recording->shadow_path.push_back(wave.paths[rays.path[i]].pixel);
  });
  wave.recording->shadow_ends.push_back(wave.recording->shadow.size());
}

/// Copies the linked vertices of a path from `entry` on, up to the last that has light: what lies behind cannot
/// contribute. Returns the end of the copy. to: has room for all of them
KbPathVertex* copy_lit_vertices(const WaveEntry* entries, uint32_t entry, KbPathVertex* to) {
  KbPathVertex *last = nullptr, *end = to;
  for (; entry != KB_NONE; entry = entries[entry].next) {
    KbPathVertex* const copy = to;
    *to++ = entries[entry].vertex;
    const bool lit = copy->head & (KB_VERTEX_EMIT | KB_VERTEX_NEE);
    copy->head &= copy->head & KB_VERTEX_NEE ? ~0u : ~KB_VERTEX_TEX_NEE;  // its sample comes last: drop it
    const uint32_t extensions = kb_vertex_extensions(copy->head);
    for (uint32_t i = 1; i <= extensions; ++i) *to++ = entries[entry + i].vertex;
    last = lit ? copy : last;
    end = lit ? to : end;
  }
  if (last) last->head &= ~(KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
  return end;
}

}  // namespace

PathTracer::PathTracer(const TracerScene& scene, const SamplingSettings& settings, const PathKernels& kernels)
    : scene_(scene),
      flat_(*scene.flat),
      settings_(settings),
      kernels_(kernels),
      sorts_(!scene.few && !flat_.features.dispersion && !flat_.features.thermal &&
             scene.embree->sorting_pays()) {
  if (flat_.features.gas) gas_.emplace(flat_, *scene.embree);
  if (flat_.features.dispersion)
    dispersion_ = std::make_unique<one_lane::DispersedPaths>(flat_, kernels.eval_heroes);
}

PathTracer::~PathTracer() = default;

void PathTracer::trace(const PixelRect& block, const SampleId& id, std::span<const float> mu, PathBuffer& out,
                       std::vector<uint32_t>& invalid) {
  out.paths.clear();
  invalid.clear();
  if (flat_.integrator.max_depth == 0) return out.entries.clear();
  const std::span<const TriangleRecord> records = scene_.records;
  Bounce bounce{flat_,
                settings_,
                id,
                0,
                gas_ ? &*gas_ : nullptr,
                dispersion_.get(),
                records.empty() ? nullptr : records.data(),
                scene_.lights.empty() ? nullptr : scene_.lights.data(),
                records.size() > kMostCachedRecords,
                dispersion_ ? dispersion_->shapes().data() : nullptr};
  wave_.paths.resize(kWavePaths + 1);
  wave_.entries.clear();
  kernels_.start(bounce, block, wave_);
  if (gas_) gas_->start(wave_);
  if (dispersion_) dispersion_->start(mu);
  const bool in_part = block.pixels() < wave_.rays().count;
  for (; wave_.rays().count > 0; ++bounce.number) {
    wave_.rare_rays.count = 0;
    if (bounce.number >= KB_MAX_VERTICES) {
      const RayQueue& rays = wave_.rays();
      for (uint32_t i = 0; i < rays.count; ++i) wave_.paths[rays.path[i]].flags |= kInvalidPath;
      break;
    }
    trace_closest(bounce.number, in_part);
    kernels_.shade(bounce, wave_);
    if (dispersion_) shade_rare_rays(bounce, wave_);
    trace_shadows();
    wave_.current = 1 - wave_.current;
  }
  gather(out, invalid);
}

/// Where packets are not coherent, paths without a pixel have done their part once camera rays are traced.
void PathTracer::drop_paths_outside() {
  RayQueue& rays = wave_.rays();
  uint32_t kept = 0;
  for (uint32_t i = 0; i < rays.count; ++i) {
    if (wave_.paths[rays.path[i]].pixel == KB_NONE) continue;
    put_ray(ray_of(rays, i), rays, kept);
    rays.path[kept++] = rays.path[i];
  }
  rays.count = kept;
}

/// in_part: only some of the wave's paths have a pixel
void PathTracer::trace_closest(uint32_t bounce, bool in_part) {
  const bool sorted = sorts_ && bounce > 0;
  if (sorted) {
    sort_rays(wave_.rays(), scene_.embree->grid(), wave_.next_rays());
    wave_.current = 1 - wave_.current;
  }
  RayQueue& rays = wave_.rays();
  wave_.traced_rays += rays.count;
  if (wave_.recording) record_closest(wave_, rays);
  if (scene_.few)
    kernels_.closest_of_few(*scene_.few, rays);
  else
    scene_.embree->closest_hits(rays,
                                sorted || bounce == 0 ? RayPackets::kCoherent : RayPackets::kIncoherent);
  if (wave_.recording) record_answers(wave_, rays);
  if (bounce == 0 && !sorts_ && in_part) drop_paths_outside();
  if (gas_) gas_->walk_boundaries(wave_);
}

/// Traces the wave's shadow rays. Returns where their answers are.
const ShadowQueue& PathTracer::answered_shadows() {
  if (sorts_) sort_rays(wave_.shadow_rays, scene_.embree->grid(), wave_.sorted_shadow_rays);
  ShadowQueue& rays = sorts_ ? wave_.sorted_shadow_rays : wave_.shadow_rays;
  wave_.traced_rays += rays.count;
  if (wave_.recording) record_shadows(wave_, rays);
  if (scene_.few)
    kernels_.occlusions_of_few(*scene_.few, rays);
  else
    scene_.embree->occlusions(rays, sorts_ ? RayPackets::kCoherent : RayPackets::kIncoherent);
  return rays;
}

void PathTracer::trace_shadows() {
  const ShadowQueue& rays = answered_shadows();
  if (gas_) return gas_->finish_shadows(wave_, rays);
  for (uint32_t i = 0; i < rays.count; ++i)  // without a branch: nobody foresees what is hidden
    wave_.entries[rays.entry[i]].vertex.head &= rays.t_max[i] < 0 ? ~KB_VERTEX_NEE : ~0u;
}

/// Copies the wave's linked vertices, each path's to one contiguous run, without what cannot contribute.
void PathTracer::gather(PathBuffer& out, std::vector<uint32_t>& invalid) const {
  out.entries.resize(wave_.entries.size());  // what is there is written over
  KbPathVertex* const begin = out.entries.data();
  KbPathVertex* end = begin;
  for (const PathState& path : std::span(wave_.paths).first(wave_.path_count)) {
    if (path.pixel == KB_NONE) continue;
    if (path.flags & kInvalidPath) {
      invalid.push_back(path.pixel);
      continue;
    }
    KbPathVertex* const first = end;
    end = copy_lit_vertices(wave_.entries.data(), path.first_entry, first);
    if (end == first) continue;
    if (path.flags & kNegativePath) first->head |= KB_VERTEX_NEGATIVE;
    out.paths.push_back(
        {static_cast<uint32_t>(first - begin), static_cast<uint32_t>(end - first), path.pixel});
  }
  out.entries.resize(static_cast<std::size_t>(end - begin));
}

}  // namespace kiloband::cpu
