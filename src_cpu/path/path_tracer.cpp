#include "src_cpu/path/path_tracer.hpp"

#include <algorithm>

#include "shared/estimator.h"
#include "shared/sampler.h"
#include "src_cpu/path/camera.hpp"
#include "src_cpu/path/rare_features.hpp"

namespace kiloband::cpu {
namespace {

/// What the lanes without a path and the pixels that a block lacks have.
constexpr PathState kNoPath{
    .bound = 1, .pixel = KB_NONE, .channel = KB_NONE, .first_entry = KB_NONE, .last_entry = KB_NONE};

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

void record_shadows(const Wave& wave) {
  const ShadowQueue& rays = wave.shadow_rays;
  for (uint32_t i = 0; i < rays.count; ++i) {
    if (!is_recorded(wave, rays.path[i])) continue;
    wave.recording->shadow.emplace_back(glm::vec3(rays.ox[i], rays.oy[i], rays.oz[i]),
                                        glm::vec3(rays.dx[i], rays.dy[i], rays.dz[i]), rays.t_max[i]);
    wave.recording->shadow_path.push_back(wave.paths[rays.path[i]].pixel);
  }
}

}  // namespace

PathTracer::PathTracer(const TracerScene& scene, const SamplingSettings& settings, const PathKernels& kernels)
    : scene_(scene),
      flat_(*scene.flat),
      settings_(settings),
      rare_(has_rare_features(flat_.features) ? std::make_unique<one_lane::RareFeatures>(flat_, *scene.embree)
                                              : nullptr),
      kernels_(rare_ ? one_lane_path_kernels() : kernels),
      secondary_order_(rare_ ? RayOrder::kMixed : scene.embree->secondary_order()) {}

PathTracer::~PathTracer() = default;

void PathTracer::trace(const PixelRect& block, const SampleId& id, std::span<const float> mu, PathBuffer& out,
                       std::vector<uint32_t>& invalid) {
  out.clear();
  invalid.clear();
  if (flat_.integrator.max_depth == 0) return;
  start(block, id);
  if (rare_) rare_->start(wave_, mu);
  Bounce bounce{flat_, settings_, id, 0, rare_.get()};
  for (; wave_.rays().count > 0; ++bounce.number) {
    if (bounce.number >= KB_MAX_VERTICES) {
      const RayQueue& rays = wave_.rays();
      for (uint32_t i = 0; i < rays.count; ++i) wave_.paths[rays.path[i]].invalid = 1;
      break;
    }
    trace_closest(bounce.number);
    kernels_.shade(bounce, wave_);
    trace_shadows();
    wave_.current = 1 - wave_.current;
  }
  gather(out, invalid);
}

/// The paths of the whole block of the film in which `block` lies; outside of `block` they have no pixel.
void PathTracer::start(const PixelRect& block, const SampleId& id) {
  const KbCamera& camera = flat_.camera;
  const uint32_t x0 = block.x0 / kBlockSize * kBlockSize, y0 = block.y0 / kBlockSize * kBlockSize;
  const uint32_t width = std::min(kBlockSize, camera.film_width - x0);
  const uint32_t height = std::min(kBlockSize, camera.film_height - y0);
  const uint32_t sampler =
      settings_.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  wave_.paths.assign(kWavePaths + 1, kNoPath);
  wave_.entries.clear();
  RayQueue& rays = wave_.rays();
  rays.count = width * height;
  for (uint32_t i = 0; i < rays.count; ++i) {
    const uint32_t x = x0 + i % width, y = y0 + i / width;
    const bool inside = x - block.x0 < block.width && y - block.y0 < block.height;
    PathState& path = wave_.paths[i];
    path.pixel = inside ? (y - block.y0) * block.width + (x - block.x0) : KB_NONE;
    path.key =
        kb_sampler_key(sampler, settings_.seed, y * camera.film_width + x, id.sample, id.replicate, id.index);
    path.magnitude = 1;
    path.previous_delta = 1;
    const CameraRay ray = sample_camera_ray(camera, x, y, kb_sampler_block(path.key, KB_BLOCK_CAMERA));
    rays.ox[i] = path.previous_point[0] = ray.origin.x;
    rays.oy[i] = path.previous_point[1] = ray.origin.y;
    rays.oz[i] = path.previous_point[2] = ray.origin.z;
    rays.dx[i] = ray.direction.x;
    rays.dy[i] = ray.direction.y;
    rays.dz[i] = ray.direction.z;
    rays.t_min[i] = ray.t_min;
    rays.t_max[i] = ray.t_max;
    rays.path[i] = i;
  }
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

void PathTracer::trace_closest(uint32_t bounce) {
  RayQueue& rays = wave_.rays();
  wave_.traced_rays += rays.count;
  if (wave_.recording) record_closest(wave_, rays);
  scene_.embree->closest_hits(rays, bounce == 0 ? RayOrder::kNeighbours : secondary_order_);
  if (wave_.recording) record_answers(wave_, rays);
  if (bounce == 0 && secondary_order_ != RayOrder::kSorted) drop_paths_outside();
  if (rare_ && rare_->gas()) rare_->gas()->walk_boundaries(wave_);
}

void PathTracer::trace_shadows() {
  if (rare_ && rare_->gas()) return rare_->gas()->trace_shadows(wave_);
  ShadowQueue& rays = wave_.shadow_rays;
  wave_.traced_rays += rays.count;
  if (wave_.recording) record_shadows(wave_);
  scene_.embree->occlusions(rays, secondary_order_);
  for (uint32_t i = 0; i < rays.count; ++i)
    if (rays.t_max[i] < 0) wave_.entries[rays.entry[i]].vertex.head &= ~KB_VERTEX_NEE;
}

/// Copies the linked vertices of every path to one contiguous run, without what cannot contribute: everything
/// behind the last vertex that has light.
void PathTracer::gather(PathBuffer& out, std::vector<uint32_t>& invalid) const {
  const std::vector<WaveEntry>& entries = wave_.entries;
  for (const PathState& path : wave_.paths) {
    if (path.pixel == KB_NONE) continue;
    if (path.invalid) {
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
      out.entries.push_back(vertex);
      for (uint32_t i = 0; i < kb_vertex_extensions(vertex.head); ++i)
        out.entries.push_back(entries[s + 1 + i].vertex);
      if (s == last_lit) break;
    }
    out.paths.push_back({first, static_cast<uint32_t>(out.entries.size()) - first, path.pixel});
  }
}

}  // namespace kiloband::cpu
