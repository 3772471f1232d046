// Path generation: paths are built without looking at a wavelength and saved for deferred evaluation.
//
// Estimator: unidirectional path tracing with next-event estimation, power-heuristic MIS over the light and
// BSDF samples, and Russian roulette with survival q = min(1, upper bound of the throughput over all
// channels). At a refraction whose index depends on wavelength one channel goes on, with weight 1 / its
// probability (channel_choice.hpp); at rough boundaries all may go on (spectral_mis.hpp).
//
// A block of 32 x 32 pixels is a wave: its paths advance together, bounce by bounce. Their rays are traced in packets
// (embree_scene.hpp), or tried against all triangles where there are few (few_triangles.hpp); what they have hit is shaded a vector of paths at a time (shade-inl.hpp), paths that have ended
// leave the queues. What has hit a dispersive surface is shaded one path after another, by the same code compiled for one lane.
//
// Which primitive a ray hits on an edge may depend on the rays that share a coherent packet. Packets are therefore those
// of the whole block, whatever part of it is asked for: crops have the bits of the whole image.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/path/gas_paths.hpp"
#include "src_cpu/path/path_buffer.hpp"
#include "src_cpu/path/path_kernels.hpp"
#include "src_cpu/path/wave.hpp"

namespace kiloband::cpu {

/// What is computed of a scene before its paths are traced, where it wins.
struct TracerTables {
  std::vector<TriangleRecord> records;
  std::vector<LightTriangle> lights;
  std::optional<FewTriangles> few;

  explicit TracerTables(const FlatScene& scene)
      : records(make_triangle_records(scene)),
        lights(make_light_triangles(scene)),
        few(find_few_triangles(scene)) {}
};

/// What all threads share.
struct TracerScene {
  const FlatScene* flat = nullptr;
  const EmbreeScene* embree = nullptr;
  std::span<const TriangleRecord> records{};  // or none
  std::span<const LightTriangle> lights{};    // or none
  const FewTriangles* few = nullptr;          // null: rays are Embree's
};

/// Refers to its arguments, which must outlive it.
inline TracerScene tracer_scene(const FlatScene& flat, const EmbreeScene& embree,
                                const TracerTables& tables) {
  return {&flat, &embree, tables.records, tables.lights, tables.few ? &*tables.few : nullptr};
}

/// Builds the paths of one block and sample. One object per thread: it owns all scratch memory.
class PathTracer {
 public:
  /// kernels: path_kernels() or one_lane_path_kernels(); which ones does not change a bit of what is traced
  PathTracer(const TracerScene& scene, const SamplingSettings& settings, const PathKernels& kernels);
  ~PathTracer();

  /// Replaces the contents of `out` by the block's paths that may contribute, in pixel order.
  /// mu       wavelength offset per pixel (per-path) or one for all (shared); read at dispersive refractions
  /// invalid  receives the indices of pixels whose sample has a non-finite weight or an endless path
  void trace(const PixelRect& block, const SampleId& id, std::span<const float> mu, PathBuffer& out,
             std::vector<uint32_t>& invalid);

  uint64_t rays() const { return wave_.traced_rays; }
  uint64_t vertices() const { return wave_.vertices; }

  /// When set, every ray that is traced is appended there.
  void record_into(Recording* recording) { wave_.recording = recording; }

 private:
  void drop_paths_outside();
  void trace_closest(uint32_t bounce, bool in_part);
  void trace_shadows();
  const ShadowQueue& answered_shadows();
  void gather(PathBuffer& out, std::vector<uint32_t>& invalid) const;

  const TracerScene& scene_;
  const FlatScene& flat_;
  SamplingSettings settings_;
  std::optional<GasPaths> gas_;                           // none: the scene has none
  std::unique_ptr<one_lane::DispersedPaths> dispersion_;  // the same
  const PathKernels kernels_;
  bool sorts_;  // secondary and shadow rays
  Wave wave_;
};

}  // namespace kiloband::cpu
