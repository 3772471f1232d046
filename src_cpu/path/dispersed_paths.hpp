// Indices of refraction that depend on wavelength: for one path at a time, in the places of a bounce (shade-inl.hpp) that call it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "src_cpu/bsdf/spectral_mis.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
#include "src_cpu/path/channel_choice.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/path/shading-inl.hpp"

namespace kiloband::cpu::one_lane {

/// A surface being shaded, as spectral_mis.hpp takes it.
struct Boundary {
  KbMaterial material;  // with the bounds of this very point
  glm::vec3 wi;
};

/// Boundaries whose index depends on wavelength: degradation to one channel, spectral MIS for all. Scenes without have none.
class DispersedPaths {
 public:
  DispersedPaths(const FlatScene& scene, EvalHeroes eval_heroes);

  /// mu: wavelength offset per pixel, or one for all
  void start(std::span<const float> mu);
  /// A dispersive surface. Returns whether that was all: rough ones are done with light and scattering for all channels
  /// at once. Else the material has the index of the path's channel, if there is one.
  bool shade(Shading& s);
  /// Refraction by an index that depends on wavelength: one channel goes on, with weight 1 / probability.
  void refract_one_channel(Shading& s, BsdfSample& sample);
  /// By shape: not 0 where one of its materials is dispersive (Bounce::rare_shapes).
  const std::vector<uint32_t>& shapes() const { return shapes_; }

 private:
  float mu_of(const PathState& path) const { return mu_[mu_.size() == 1 ? 0 : path.pixel]; }
  float channel_eta(const KbMaterial& material, uint32_t channel, float mu) const;
  BinnedThroughput carried(const Shading& s) const;
  float survive(const Shading& s, const BinnedThroughput& carried);
  void degrade(Shading& s);
  HeroSet choose_heroes(const Shading& s, const KbMaterial& material);
  void append_pair(Shading& s, const Boundary& at, const BoundaryPair& pair, glm::vec3 wo, Vertex v);
  void add_hero_light(Shading& s, const Boundary& at, const HeroSet& heroes);
  void scatter_heroes(Shading& s, const Boundary& at, const HeroSet& heroes);

  const FlatScene& scene_;
  EvalHeroes eval_heroes_;
  std::span<const float> mu_;
  std::vector<std::array<float, KB_MAX_HEROES>> hero_weights_;  // q_c of a path's heroes
  std::vector<uint32_t> shapes_;
};

}  // namespace kiloband::cpu::one_lane
