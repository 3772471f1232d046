// The stages of a wave that are compiled for every instruction set.
#pragma once

#include "src_cpu/bsdf/spectral_mis.hpp"
#include "src_cpu/geometry/few_triangles.hpp"
#include "src_cpu/lanes/isa.hpp"
#include "src_cpu/path/wave.hpp"

namespace kiloband::cpu {

struct PathKernels {
  /// Camera rays of the whole block of the film in which `block` lies -> wave.rays() and the states of the paths, which
  /// outside of `block` have no pixel.
  void (*start)(const Bounce& bounce, const PixelRect& block, Wave& wave);
  /// Answers of wave.rays -> saved vertices, wave.shadow_rays, wave.next_rays, the states of the paths and what Bounce::gas knows of them;
  /// what has hit a shape of Bounce::rare_shapes is added to wave.rare_rays.
  void (*shade)(const Bounce& bounce, Wave& wave);
  /// Answer all rays of a queue in scenes that have few triangles.
  void (*closest_of_few)(const FewTriangles& few, RayQueue& rays);
  void (*occlusions_of_few)(const FewTriangles& few, ShadowQueue& rays);
  EvalHeroes eval_heroes;
};

/// For an instruction set that this machine has (resolve_isa()). All give the same bits for the same answers.
const PathKernels& path_kernels(Isa isa);
/// One path after another, by plain numbers: the oracle of the others.
const PathKernels& one_lane_path_kernels();
/// The paths of wave.rare_rays, with Bounce::dispersion, after PathKernels::shade.
void shade_rare_rays(const Bounce& bounce, Wave& wave);

}  // namespace kiloband::cpu
