// What few scenes have: gas, indices of refraction that depend on wavelength. For one path at a time,
// in the places of a bounce (shade-inl.hpp) that call it; scenes without pay nothing.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "src_cpu/bsdf/spectral_mis.hpp"
#include "src_cpu/geometry/embree_scene.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
#include "src_cpu/path/channel_choice.hpp"
#include "src_cpu/path/medium_stack.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/path/shading-inl.hpp"

namespace kiloband::cpu::one_lane {

// ---- gas (gas_paths.cpp) -----------------------------------------------------------------------------

/// Gas along the rays of paths: null boundaries are passed, and every segment in a gas becomes a vertex. Without an atmosphere, paths
/// that are in no medium and meet none are left to the lanes: nothing is noted of them.
class GasPaths {
 public:
  GasPaths(const FlatScene& scene, const EmbreeScene& embree) : scene_(scene), embree_(embree) {}

  /// The wave's paths begin where the camera is.
  void start(Wave& wave);
  /// Whether some paths may be left to the lanes.
  bool separates() const { return scene_.atmosphere == KB_NONE; }
  /// Follows every ray of the queue to the first surface that is one, and notes its segments. Where it separates, what is not for the
  /// lanes goes to rare_rays.
  void walk_boundaries(Wave& wave);
  /// The gas between where the path was and where it is now, or on its way out of the scene.
  void append(Wave& wave, uint32_t path, bool escapes);
  /// The path goes on with the ray that was queued last.
  void follow_ray(const Shading& s);
  /// The same for the shadow ray that is queued behind the last.
  void note_shadow_ray(const Shading& s);
  /// Light samples: what packets find nothing in front of has one medium along its ray, the others go through null boundaries one by one.
  void trace_shadows(Wave& wave);

 private:
  /// Where a path is, and the segments of the ray at hand.
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
    float begin;  // ray parameter: on the surface that it left
    MediumStack media;
  };

  bool is_plain(const GasPath& gas, uint32_t crossings_before, uint32_t shape) const;
  void cross(PathState& path, MediumStack& media, uint32_t shape, bool outwards) const;
  MediumStack media_towards(const Shading& s, glm::vec3 direction) const;
  void pass_boundary(Wave& wave, PathState& path, GasPath& gas, TraceRay& ray) const;
  void append_segment(Wave& wave, uint32_t path, const KbMedium& medium, const Segment& segment) const;
  Columns clear_columns(Wave& wave, const ShadowOwner& at, const ShadowRay& shadow) const;
  bool walk_shadow(Wave& wave, ShadowOwner at, const ShadowRay& shadow, Columns& columns) const;
  void add_column(PathState& path, Columns& columns, uint32_t medium, const TraceRay& ray, float begin) const;
  void append_columns(Wave& wave, uint32_t path, uint32_t entry, const Columns& columns) const;

  const FlatScene& scene_;
  const EmbreeScene& embree_;
  std::vector<GasPath> paths_;
  std::vector<Segment> segments_;
  std::vector<float> shadow_ends_;          // of all shadow rays, ray parameters
  std::vector<ShadowOwner> shadow_owners_;  // of the last shadow rays; those before are of paths in no medium
};

// ---- dispersion (dispersed_paths.cpp) ----------------------------------------------------------------

/// A surface being shaded, as spectral_mis.hpp takes it.
struct Boundary {
  KbMaterial material;  // with the bounds of this very point
  glm::vec3 wi;
};

/// Boundaries whose index depends on wavelength: degradation to one channel, spectral MIS for all.
class DispersedPaths {
 public:
  DispersedPaths(const FlatScene& scene, EvalHeroes eval_heroes);

  /// mu: wavelength offset per pixel, or one for all
  void start(std::span<const float> mu);
  /// A dispersive surface. Returns whether that was all: rough ones are done with light and scattering for all channels
  /// at once. Else the material has the index of the path's channel, if there is one.
  bool shade(Shading& s, RareFeatures& rare);
  /// Refraction by an index that depends on wavelength: one channel goes on, with weight 1 / probability.
  void refract_one_channel(Shading& s, BsdfSample& sample);
  /// By shape: not 0 where one of its materials is dispersive.
  const std::vector<uint32_t>& shapes() const { return shapes_; }

 private:
  float mu_of(const PathState& path) const { return mu_[mu_.size() == 1 ? 0 : path.pixel]; }
  float channel_eta(const KbMaterial& material, uint32_t channel, float mu) const;
  BinnedThroughput carried(const Shading& s) const;
  float survive(const Shading& s, const BinnedThroughput& carried);
  void degrade(Shading& s);
  HeroSet choose_heroes(const Shading& s, const KbMaterial& material);
  void append_pair(Shading& s, const Boundary& at, const BoundaryPair& pair, glm::vec3 wo, Vertex v);
  void add_hero_light(Shading& s, const Boundary& at, const HeroSet& heroes, RareFeatures& rare);
  bool scatter_heroes(Shading& s, const Boundary& at, const HeroSet& heroes);

  const FlatScene& scene_;
  EvalHeroes eval_heroes_;
  std::span<const float> mu_;
  std::vector<std::array<float, KB_MAX_HEROES>> hero_weights_;  // q_c of a path's heroes
  std::vector<uint32_t> shapes_;
};

/// All of them, as far as the scene has them.
class RareFeatures {
 public:
  RareFeatures(const FlatScene& scene, const EmbreeScene& embree, EvalHeroes eval_heroes) {
    if (scene.features.gas) gas_.emplace(scene, embree);
    if (scene.features.dispersion) dispersion_.emplace(scene, eval_heroes);
  }

  void start(Wave& wave, std::span<const float> mu) {
    if (gas_) gas_->start(wave);
    if (dispersion_) dispersion_->start(mu);
  }
  GasPaths* gas() { return gas_ ? &*gas_ : nullptr; }
  /// Whether some paths may be left to the lanes; else all are for one at a time.
  bool separates() const { return !gas_ || gas_->separates(); }
  /// What Bounce::rare_shapes is where it separates.
  const uint32_t* dispersive_shapes() const { return dispersion_ ? dispersion_->shapes().data() : nullptr; }

  void pass_gas(const Shading& s, bool escapes) {
    if (gas_) gas_->append(s.wave, s.path.v, escapes);
  }
  bool shade_dispersive(Shading& s) { return dispersion_ && dispersion_->shade(s, *this); }
  void refract_one_channel(Shading& s, BsdfSample& sample) { dispersion_->refract_one_channel(s, sample); }
  void note_shadow_ray(const Shading& s) {
    if (gas_) gas_->note_shadow_ray(s);
  }
  void follow_ray(const Shading& s) {
    if (gas_) gas_->follow_ray(s);
  }

 private:
  std::optional<GasPaths> gas_;
  std::optional<DispersedPaths> dispersion_;
};

}  // namespace kiloband::cpu::one_lane
