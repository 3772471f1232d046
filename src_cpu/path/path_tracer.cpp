#include "src_cpu/path/path_tracer.hpp"

#include "shared/estimator.h"
#include "src_cpu/path/rare_features.hpp"

namespace kiloband::cpu {
namespace {

/// 512 KiB: about as much as the second-level cache has for them.
constexpr std::size_t kMostCachedRecords = 8192;

bool has_rare_features(const SceneFeatures& f) {
  return f.gas || f.dispersion || f.thermal || f.compensation;
}

/// Paths without a pixel are traced for their neighbours' sake alone.
bool is_recorded(const Wave& wave, uint32_t path) {
  return wave.paths[path].pixel != KB_NONE;
}

void record_closest(const Wave& wave, const RayQueue& rays) {
  for (uint32_t i = 0; i < rays.count; ++i) {
    if (!is_recorded(wave, rays.path[i])) continue;
    wave.recording->closest.emplace_back(glm::vec3(rays.ox[i], rays.oy[i], rays.oz[i]),
                                         glm::vec3(rays.dx[i], rays.dy[i], rays.dz[i]), rays.t_min[i],
                                         rays.t_max[i]);
    wave.recording->closest_path.push_back(wave.paths[rays.path[i]].pixel);
  }
  wave.recording->closest_ends.push_back(wave.recording->closest.size());
}

void record_answers(const Wave& wave, const RayQueue& rays) {
  Recording& recording = *wave.recording;
  for (uint32_t i = 0; i < rays.count; ++i) {
    if (!is_recorded(wave, rays.path[i])) continue;
    TraceRay& answer = recording.answers.emplace_back(recording.closest[recording.answers.size()]);
    answer.t_max = rays.t_max[i];
    answer.u = rays.u[i];
    answer.v = rays.v[i];
    answer.primitive = rays.primitive[i];
    answer.shape = rays.shape[i];
  }
}

void record_shadows(const Wave& wave, const ShadowQueue& rays) {
  for (uint32_t i = 0; i < rays.count; ++i) {
    if (!is_recorded(wave, rays.path[i])) continue;
    wave.recording->shadow.emplace_back(glm::vec3(rays.ox[i], rays.oy[i], rays.oz[i]),
                                        glm::vec3(rays.dx[i], rays.dy[i], rays.dz[i]), rays.t_max[i]);
    wave.recording->shadow_path.push_back(wave.paths[rays.path[i]].pixel);
  }
  wave.recording->shadow_ends.push_back(wave.recording->shadow.size());
}

}  // namespace

PathTracer::PathTracer(const TracerScene& scene, const SamplingSettings& settings, const PathKernels& kernels)
    : scene_(scene),
      flat_(*scene.flat),
      settings_(settings),
      rare_(has_rare_features(flat_.features) ? std::make_unique<one_lane::RareFeatures>(flat_, *scene.embree)
                                              : nullptr),
      kernels_(rare_ ? one_lane_path_kernels() : kernels),
      sorts_(!rare_ && scene.embree->sorting_pays()) {}

PathTracer::~PathTracer() = default;

void PathTracer::trace(const PixelRect& block, const SampleId& id, std::span<const float> mu, PathBuffer& out,
                       std::vector<uint32_t>& invalid) {
  out.clear();
  invalid.clear();
  if (flat_.integrator.max_depth == 0) return;
  const std::span<const TriangleRecord> records = scene_.records;
  Bounce bounce{flat_,
                settings_,
                id,
                0,
                rare_.get(),
                records.empty() ? nullptr : records.data(),
                records.size() > kMostCachedRecords};
  wave_.paths.resize(kWavePaths + 1);
  wave_.entries.clear();
  kernels_.start(bounce, block, wave_);
  if (rare_) rare_->start(wave_, mu);
  const bool in_part = block.pixels() < wave_.rays().count;
  for (; wave_.rays().count > 0; ++bounce.number) {
    if (bounce.number >= KB_MAX_VERTICES) {
      const RayQueue& rays = wave_.rays();
      for (uint32_t i = 0; i < rays.count; ++i) wave_.paths[rays.path[i]].flags |= kInvalidPath;
      break;
    }
    trace_closest(bounce.number, in_part);
    kernels_.shade(bounce, wave_);
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
    for (float* array :
         {rays.ox, rays.oy, rays.oz, rays.t_min, rays.dx, rays.dy, rays.dz, rays.t_max, rays.u, rays.v})
      array[kept] = array[i];
    for (uint32_t* array : {rays.primitive, rays.shape, rays.path}) array[kept] = array[i];
    ++kept;
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
  scene_.embree->closest_hits(rays, sorted || bounce == 0 ? RayPackets::kCoherent : RayPackets::kIncoherent);
  if (wave_.recording) record_answers(wave_, rays);
  if (bounce == 0 && !sorts_ && in_part) drop_paths_outside();
  if (rare_ && rare_->gas()) rare_->gas()->walk_boundaries(wave_);
}

/// Traces the wave's shadow rays. Returns where their answers are.
const ShadowQueue& PathTracer::answered_shadows() {
  if (sorts_) sort_rays(wave_.shadow_rays, scene_.embree->grid(), wave_.sorted_shadow_rays);
  ShadowQueue& rays = sorts_ ? wave_.sorted_shadow_rays : wave_.shadow_rays;
  wave_.traced_rays += rays.count;
  if (wave_.recording) record_shadows(wave_, rays);
  scene_.embree->occlusions(rays, sorts_ ? RayPackets::kCoherent : RayPackets::kIncoherent);
  return rays;
}

void PathTracer::trace_shadows() {
  if (rare_ && rare_->gas()) return rare_->gas()->trace_shadows(wave_);
  const ShadowQueue& rays = answered_shadows();
  for (uint32_t i = 0; i < rays.count; ++i)
    if (rays.t_max[i] < 0) wave_.entries[rays.entry[i]].vertex.head &= ~KB_VERTEX_NEE;
}

/// Copies the linked vertices of every path to one contiguous run, without what cannot contribute: everything
/// behind the last vertex that has light.
void PathTracer::gather(PathBuffer& out, std::vector<uint32_t>& invalid) const {
  const std::vector<WaveEntry>& entries = wave_.entries;
  for (const PathState& path : wave_.paths) {
    if (path.pixel == KB_NONE) continue;
    if (path.flags & kInvalidPath) {
      invalid.push_back(path.pixel);
      continue;
    }
    uint32_t last_lit = KB_NONE;
    for (uint32_t s = path.first_entry; s != KB_NONE; s = entries[s].next) {
      if (entries[s].vertex.head & (KB_VERTEX_EMIT | KB_VERTEX_NEE)) last_lit = s;
    }
    if (last_lit == KB_NONE) continue;
    const auto first = static_cast<uint32_t>(out.entries.size());
    for (uint32_t s = path.first_entry;; s = entries[s].next) {
      KbPathVertex vertex = entries[s].vertex;
      if (!(vertex.head & KB_VERTEX_NEE))
        vertex.head &= ~KB_VERTEX_TEX_NEE;  // its sample comes last: drop it
      if (s == last_lit) vertex.head &= ~(KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
      if (s == path.first_entry && (path.flags & kNegativePath)) vertex.head |= KB_VERTEX_NEGATIVE;
      out.entries.push_back(vertex);
      for (uint32_t i = 0; i < kb_vertex_extensions(vertex.head); ++i)
        out.entries.push_back(entries[s + 1 + i].vertex);
      if (s == last_lit) break;
    }
    out.paths.push_back({first, static_cast<uint32_t>(out.entries.size()) - first, path.pixel});
  }
}

}  // namespace kiloband::cpu
