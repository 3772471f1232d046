// Two records of the same path, from two backends: do they agree, and if not, what are they worth?
#pragma once

#include <vector>

#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"

namespace kiloband::test {

/// Where two records of a path part first.
enum class Parting { kNone, kHits, kDecisions, kValues };

/// Compares hits (shape, triangle) and vertices (kind, flags, material, rows, textures and texels, channel of
/// a degradation): kHits, kDecisions or kNone.
Parting compare_decisions(const TracedPath& a, const TracedPath& b);

/// The path's value in every channel, W m^-2 sr^-1, from its vertices by the double-precision evaluator.
std::vector<double> path_values(const FlatScene& scene, const TracedPath& path, double mu);

/// Values agree if no channel differs by more than 1e-4 of the path's largest channel, or of `least` where
/// the path is worth less (a thousandth of the mean path: what is missing then does not show in a pixel's
/// float). Weights of single vertices are not compared: those of a vertex that adds little may be differences
/// of larger numbers.
bool values_agree(const std::vector<double>& a, const std::vector<double>& b, double least);

}  // namespace kiloband::test
