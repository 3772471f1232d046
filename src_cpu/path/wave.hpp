// A wave of paths: what its stages read and write (path_tracer.hpp).
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "shared/sampler.h"
#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/geometry/ray_queue.hpp"
#include "src_cpu/geometry/triangle_records.hpp"
#include "src_cpu/light/light_triangles.hpp"

namespace kiloband::cpu {

/// Which sample of every pixel: number `sample` of the pixel, `index` of its replicate.
struct SampleId {
  uint32_t sample = 0;
  uint32_t replicate = 0;
  uint32_t index = 0;
};

inline constexpr uint32_t kInvalidPath = 1;   // a weight is not finite, or the path is endless
inline constexpr uint32_t kNegativePath = 2;  // KB_VERTEX_NEGATIVE of its first vertex

/// What is known of a path between bounces, in one cache line. Lanes gather its members.
struct alignas(64) PathState {
  float previous_point[3];  // m
  float previous_pdf;       // solid angle [1/sr], of the BSDF sample that led here; 0 for delta lobes
  float bound;              // upper bound of the throughput over all channels, without radiance scaling
  float magnitude;          // product of the scatter weights: where this overflows the sample is invalid
  uint32_t previous_delta;  // the BSDF sample was one of a delta lobe, or the camera's
  uint32_t flags;           // kInvalidPath, kNegativePath
  uint32_t pixel;           // in the block
  uint32_t channel;         // after degradation, else KB_NONE
  uint32_t first_entry, last_entry;  // linked list in the wave's entries
  uint32_t facing;  // of previous_point, where light of an environment map is sampled (shared/environment.h)
  // Of its KbSamplerKey, what differs between paths:
  uint32_t film_pixel;
  uint32_t key0, key1;
};
static_assert(sizeof(PathState) == 64);

/// What the lanes without a path and the pixels that a block lacks have.
inline constexpr PathState kNoPath{
    .bound = 1, .pixel = KB_NONE, .channel = KB_NONE, .first_entry = KB_NONE, .last_entry = KB_NONE};

/// A saved vertex, or what follows one directly: two texture samples, four cells of a plume.
struct WaveEntry {
  KbPathVertex vertex;
  uint32_t next;  // the path's next vertex
  WaveEntry() {}  // sets nothing: who adds one fills it in
  /// What follows a vertex, at most as large as one.
  WaveEntry(const void* from, std::size_t bytes) : vertex{}, next(KB_NONE) {
    std::memcpy(static_cast<void*>(&vertex), from, bytes);
  }
};

/// Every ray that is traced, with its path's index in the block (benchmarks of bare queries, traced paths).
struct Recording {
  std::vector<TraceRay> closest;
  std::vector<ShadowRay> shadow;
  std::vector<uint32_t> closest_path, shadow_path;
  std::vector<std::size_t> closest_ends, shadow_ends;  // of the queues that were traced
  std::vector<TraceRay> answers;                       // of `closest`: what was hit
};

struct Wave {
  std::vector<PathState> paths;  // kWavePaths, and one behind the last that lanes without a path write to
  uint32_t path_count = 0;       // of those, the first: a film may be smaller than a block
  std::vector<WaveEntry> entries;
  RayQueue queues[2];  // what is traced, and what the next bounce will trace
  uint32_t current = 0;
  EscapeQueue escaped;
  RayQueue rare_rays;  // that are for one path at a time: they have hit a shape of Bounce::rare_shapes
  ShadowQueue shadow_rays, sorted_shadow_rays;
  uint64_t vertices = 0, traced_rays = 0;
  Recording* recording = nullptr;  // appended to

  RayQueue& rays() { return queues[current]; }
  RayQueue& next_rays() { return queues[1 - current]; }
};

/// An entry for a vertex behind what the path has saved; who asks for it fills in the vertex.
inline WaveEntry& add_entry(Wave& wave, PathState& state) {
  const auto index = static_cast<uint32_t>(wave.entries.size());
  (state.last_entry == KB_NONE ? state.first_entry : wave.entries[state.last_entry].next) = index;
  state.last_entry = index;
  WaveEntry& entry = wave.entries.emplace_back();
  entry.next = KB_NONE;
  return entry;
}

class GasPaths;
namespace one_lane {
class DispersedPaths;
}

/// What is the same for all paths of a bounce.
struct Bounce {
  const FlatScene& scene;
  const SamplingSettings& settings;
  SampleId id;
  uint32_t number = 0;                             // 0: what camera rays hit
  GasPaths* gas = nullptr;                         // null: the scene has none
  one_lane::DispersedPaths* dispersion = nullptr;  // the same; one lane alone uses it
  const TriangleRecord* records = nullptr;         // null: hits are made from the arrays of the scene
  const LightTriangle* lights = nullptr;           // null: so are light samples
  bool prefetches = false;                         // records, which are more than the caches hold
  const uint32_t* rare_shapes =
      nullptr;  // not 0: what hits the shape is for one path at a time; null: there is none

  uint32_t sampler() const {
    return settings.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  }
  /// Whether paths go on from here; else they end with the emission of what they hit.
  bool goes_on() const {
    const int max_depth = scene.integrator.max_depth;
    return max_depth < 0 || number + 1 < static_cast<uint32_t>(max_depth);
  }
};

}  // namespace kiloband::cpu
