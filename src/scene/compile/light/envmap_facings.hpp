// How much of an environment map's regions the facings of receivers see (shared/environment.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband {

/// A region that a facing sees at all counts at least this much beside the mean cosine, at most 1: what a region's
/// brightest cells have above the region's mean cosine stays bounded.
inline constexpr double kLeastFacingWeight = 0.02;

/// Unit normal, in the map's frame, at (i + x, j + y) cells of the octahedral map.
glm::dvec3 facing_normal(uint32_t facing, double x, double y);

/// Weights of the map's regions, [region row][region column], for receivers of a facing: the cosine between normal and direction where that is
/// positive, averaged over the facing and the region, and kLeastFacingWeight; 0 for regions that no normal of the facing sees. 1 everywhere
/// for KB_ALL_FACINGS. Of `sampling` only the sizes are used. (Regions that are called unseen by the sampled averages may be seen by a corner:
/// samples of BSDFs have weight 1 there.)
std::vector<double> envmap_facing_weights(const EnvmapSampling& sampling, uint32_t facing);

}  // namespace kiloband
