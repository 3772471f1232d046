// Texture coordinates that a file gives by corners of faces and not by vertices.
#pragma once

#include "scene/mesh/mesh.hpp"

namespace kiloband {

/// Texture coordinates of a triangle's three corners.
using CornerUvs = std::array<Vec2f, 3>;

/// Gives the mesh these texture coordinates, one entry per triangle. A vertex that has several is split: the first
/// keeps its place, the others follow behind the last vertex and have its position, normal and attributes.
void set_corner_uvs(Mesh& mesh, const std::vector<CornerUvs>& uvs);

}  // namespace kiloband
