// Two records of the same path, from two backends: do they agree, and if not, what are they worth?
#pragma once

#include <string>

#include "render/backend.hpp"
#include "scene/flat_scene.hpp"

namespace kiloband::test {

/// Where two records of a path part first.
enum class Parting { kNone, kHits, kDecisions, kWeights };

/// Compares hits (shape, triangle), vertices (kind, flags, material, rows, textures and texels, channel of a
/// degradation) and then weights.
/// Weights agree if they differ by at most 1e-4 of the larger one, or of 1e-3 of the path's largest where
/// both are smaller: the factor 1e-7 of the path's largest weight is one rounding of a float, and what is
/// beneath it does not show in the path's value. Cosines and the fractions of bilinear lookups agree within
/// 1e-4.
Parting compare_paths(const TracedPath& a, const TracedPath& b);

/// The path's value: its channels' mean, W m^-2 sr^-1, from its vertices by the double-precision evaluator.
double path_value(const FlatScene& scene, const TracedPath& path, double mu);

}  // namespace kiloband::test
