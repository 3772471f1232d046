// Path generation: paths are built without looking at a wavelength and saved for deferred evaluation.
//
// Estimator: unidirectional path tracing with next-event estimation, power-heuristic MIS over the light and
// BSDF samples, and Russian roulette with survival q = min(1, upper bound of the throughput over all
// channels). At a refraction whose index depends on wavelength one channel goes on, with weight 1 / its
// probability (channel_choice.hpp); at rough boundaries all may go on (spectral_mis.hpp).
//
// Sixteen neighbouring pixels advance together, bounce by bounce: their camera rays are one packet for
// Embree, and what one bounce touched of the scene is still in the caches at the next. Secondary rays go one
// by one (packets lose: see validation/README.md).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "shared/sampler.h"
#include "src_cpu/bsdf/bsdf.hpp"
#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/geometry/surface_hit.hpp"
#include "src_cpu/light/emitter.hpp"
#include "src_cpu/path/channel_choice.hpp"
#include "src_cpu/path/medium_stack.hpp"
#include "src_cpu/path/path_buffer.hpp"
#include "src_cpu/path/spectral_mis.hpp"

namespace kiloband::cpu {

/// What all threads share.
struct TracerScene {
  const FlatScene* flat = nullptr;
  const EmbreeScene* embree = nullptr;
};

/// Which sample of every pixel: number `sample` of the pixel, `index` of its replicate.
struct SampleId {
  uint32_t sample = 0;
  uint32_t replicate = 0;
  uint32_t index = 0;
};

/// Builds the paths of one block and sample. One object per thread: it owns all scratch memory.
class PathTracer {
 public:
  PathTracer(const TracerScene& scene, const SamplingSettings& settings);

  /// Replaces the contents of `out` by the block's paths that may contribute, in pixel order.
  /// mu       wavelength offset per pixel (per-path) or one for all (shared); read at dispersive refractions
  /// invalid  receives the indices of pixels whose sample has a non-finite weight or an endless path
  void trace(const PixelRect& block, const SampleId& id, std::span<const float> mu, PathBuffer& out,
             std::vector<uint32_t>& invalid);

  uint64_t rays() const { return rays_; }
  uint64_t vertices() const { return vertices_; }

  /// When set, every ray that is traced is appended here with its path's index in the block
  /// (benchmarks of bare queries).
  struct Recording {
    std::vector<TraceRay> closest;
    std::vector<ShadowRay> shadow;
    std::vector<uint32_t> closest_path, shadow_path;
    std::vector<TraceRay> answers;  // of `closest`: what was hit
  };
  void record_into(Recording* recording) { recording_ = recording; }

 private:
  struct Path {
    glm::vec3 previous_point;
    float previous_pdf;  // solid angle, of the BSDF sample that led here
    float bound;         // upper bound of the throughput over all channels, without radiance scaling
    uint32_t pixel;      // in the block
    KbSamplerKey key;    // of the path's random numbers
    uint32_t channel;    // after degradation, else KB_NONE
    uint32_t first_entry, last_entry;  // linked list in entries_
    float magnitude;  // product of the scatter weights: where this overflows the sample is invalid
    bool previous_delta;
    bool invalid;
  };
  /// What a path carries in scenes with dispersion besides.
  struct DispersedPath {
    BinnedThroughput carried;                         // in each bin of channels
    uint32_t heroes = 0;                              // of spectral MIS; 0: none chosen yet
    std::array<float, KB_MAX_HEROES> hero_weights{};  // q_c
  };
  struct Entry {
    KbPathVertex vertex;
    uint32_t next;
  };
  /// A vertex under construction with the texture samples that follow it.
  struct Draft {
    KbPathVertex vertex{};
    KbTextureSample samples[4];
    uint32_t sample_count = 0;
    float scale = 1;  // largest spectral factor of its weights, where that is not of order 1
  };

  /// Where a path is in a scene with gas, and the segments of the ray at hand.
  struct GasPath {
    MediumStack media;
    uint32_t crossings = 0;  // null boundaries passed
    float begin, far;  // where the ray at hand begins (on the surface that it left) and ends: ray parameters
    uint32_t first_segment = 0, segments = 0;
  };
  /// A part of a ray in one medium (KB_NONE: in none).
  struct Segment {
    uint32_t medium;
    glm::vec3 origin, direction;
    float t_min, t_max;
  };
  /// The gases that a shadow ray passes.
  struct Columns {
    uint32_t count = 0;
    uint32_t medium[KB_SHADOW_MEDIA];
    float column[KB_SHADOW_MEDIA];  // m
  };
  struct ShadowOwner {
    uint32_t path;
    float begin;
    MediumStack media;
  };

  void start_paths(const PixelRect& block, uint32_t first, uint32_t count, const SampleId& id);
  void run_wavefront(const SampleId& id, std::span<const float> mu);
  void record_closest();
  void record_shadows();
  void trace_closest(bool coherent);
  void trace_shadows();
  void prefetch_vertices() const;
  void shade_all(const SampleId& id, uint32_t bounce, std::span<const float> mu);
  /// Returns false where the path ends.
  bool shade(Path& path, const TraceRay& ray, const SampleId& id, uint32_t bounce, std::span<const float> mu);
  void add_escaped(Path& path, const TraceRay& ray, uint32_t bounce);
  void add_emission(Draft& draft, const Path& path, const SurfaceHit& hit, glm::vec3 direction,
                    uint32_t bounce);
  void add_thermal_emission(Draft& draft, const Path& path, const SurfaceHit& hit, glm::vec3 direction,
                            const SampleId& id, uint32_t bounce);
  LightSample choose_light(const Path& path, const SurfaceHit& hit, const SampleId& id,
                           uint32_t bounce) const;
  bool add_light_sample(Draft& draft, Path& path, const SurfaceHit& hit, const ShadingFrame& frame,
                        const MaterialContext& material, glm::vec3 wi, float opacity, const SampleId& id,
                        uint32_t bounce);
  bool scatter(Draft& draft, Path& path, const SurfaceHit& hit, const ShadingFrame& frame,
               MaterialContext& material, glm::vec3 wi, const KbFloat4& u, float opacity, const SampleId& id,
               uint32_t bounce, float mu);
  void queue_shadow_ray(const SurfaceHit& hit, const LightSample& light);
  bool refract_one_channel(Draft& draft, Path& path, const KbMaterial& material, glm::vec3 wi,
                           BsdfSample& sample, const SampleId& id, uint32_t bounce, float mu);
  float survive(Path& path, const BinnedThroughput& carried, const SampleId& id, uint32_t bounce);
  void degrade(Path& path, const SampleId& id, uint32_t bounce);
  /// A surface being shaded, for the steps of one bounce.
  struct Boundary {
    const SurfaceHit& hit;
    const ShadingFrame& frame;
    const KbMaterial& material;
    uint32_t side;  // its index
    glm::vec3 wi;
    float opacity;
    glm::vec3 direction;  // of the ray that arrived
  };
  HeroSet choose_heroes(const Path& path, const KbMaterial& material, const SampleId& id, float mu);
  DispersedPath& dispersed(const Path& path) { return dispersed_[index_of(path)]; }
  bool add_hero_light(Path& path, const Boundary& at, const HeroSet& heroes, const SampleId& id,
                      uint32_t bounce);
  bool scatter_heroes(Path& path, const Boundary& at, const HeroSet& heroes, const KbFloat4& u,
                      const SampleId& id, uint32_t bounce);
  void append_pair(Path& path, Draft& draft, const Boundary& at, const BoundaryPair& pair, glm::vec3 wo);
  bool roulette(Draft& draft, Path& path, uint32_t bounce, float u);
  void continue_ray(const SurfaceHit& hit, glm::vec3 direction);
  void pass_through(Path& path, const SurfaceHit& hit, glm::vec3 direction);
  void append(Path& path, const Draft& draft);
  void resolve_spectra(Draft& draft, const KbMaterial& material, const SurfaceHit& hit, bool use_b_for_a);
  const KbMaterial& with_local_bounds(const KbMaterial& material, const SurfaceHit& hit,
                                      KbMaterial& local) const;
  // path_tracer_gas.cpp
  GasPath& gas_of(const Path& path) { return gas_[index_of(path)]; }
  void cross(Path& path, MediumStack& media, uint32_t shape, bool outwards);
  MediumStack media_towards(Path& path, const SurfaceHit& hit, glm::vec3 from, glm::vec3 direction);
  void walk_boundaries();
  void pass_boundary(Path& path, GasPath& gas, TraceRay& ray);
  void append_gas(Path& path, bool escapes);
  void append_segment(Path& path, const KbMedium& medium, const Segment& segment);
  void append_medium(Path& path, const KbPathVertex& vertex, std::span<const KbPlumeCell> cells);
  void follow_gas(Path& path, const SurfaceHit& hit, glm::vec3 from);
  void note_shadow(Path& path, const SurfaceHit& hit, glm::vec3 from);
  void trace_shadows_through_gas();
  bool walk_shadow(Path& path, ShadowOwner begin, const ShadowRay& shadow, Columns& columns);
  void add_column(Path& path, Columns& columns, uint32_t medium, const TraceRay& ray, float begin);
  void append_columns(Path& path, uint32_t entry, const Columns& columns);
  void gather(PathBuffer& out, std::vector<uint32_t>& invalid);
  float channel_eta(const KbMaterial& material, uint32_t channel, float mu) const;
  bool wants_bounce(uint32_t bounce) const;
  std::size_t index_of(const Path& path) const { return static_cast<std::size_t>(&path - paths_.data()); }

  const TracerScene& scene_;
  const FlatScene& flat_;
  SamplingSettings settings_;
  std::vector<Path> paths_;
  std::vector<uint32_t> active_, next_active_;
  std::vector<TraceRay> rays_queue_, next_rays_;
  std::vector<ShadowRay> shadow_rays_;
  std::vector<uint32_t> shadow_entry_;  // vertex of each shadow ray
  std::vector<uint32_t> shadow_path_;   // while recording: its path
  std::vector<Entry> entries_;
  std::vector<DispersedPath> dispersed_;  // as paths_; empty in scenes without dispersion
  std::vector<GasPath> gas_;              // as paths_; this and the next two are empty in scenes without gas
  std::vector<Segment> segments_;
  std::vector<ShadowOwner> shadow_owner_;  // as shadow_rays_
  Recording* recording_ = nullptr;
  uint64_t rays_ = 0, vertices_ = 0;
};

}  // namespace kiloband::cpu
