// What a mesh must be like to be rendered without surprises.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "scenes/generator/scenes.hpp"

namespace kiloband::test {

/// Edges after joining vertices at equal positions: how often they are walked from the lower
/// to the higher end, and back.
struct EdgeUse {
  int forward = 0, backward = 0;
};
std::map<std::pair<uint32_t, uint32_t>, EdgeUse> edge_uses(const generator::Mesh& mesh);

/// Each edge is walked as often one way as the other: the mesh bounds a volume,
/// and its triangles agree on the outside.
bool is_closed(const generator::Mesh& mesh);
/// Closed, and each edge belongs to exactly two triangles.
bool is_manifold(const generator::Mesh& mesh);
/// No edge is walked the same way by two triangles, but for edges at which closed pieces touch:
/// orientation is consistent.
bool is_oriented(const generator::Mesh& mesh);

/// Empty, or the first rule that the mesh breaks: indices, finite values, normals of unit length,
/// triangles of some area.
std::string fault_of(const generator::Mesh& mesh);
/// Share of triangle corners whose normal looks to the other side of the triangle than its front.
double share_of_turned_normals(const generator::Mesh& mesh);

/// Expects all of that of a scene's parts. Returns how many triangles they have.
std::size_t check_parts(const generator::Scene& scene);

}  // namespace kiloband::test
