// Vertices split where a surface has creases: `max_smooth_angle`.
#pragma once

#include "scene/mesh/mesh.hpp"

namespace kiloband {

/// Makes vertices such that two triangles share one if and only if edges between neighbours at most `most_rad` apart lead from
/// the one to the other around it. Vertices of equal position, texture coordinates and attributes are one before,
/// vertex normals are dropped, and what no triangle uses. Normals computed of the result
/// (compute_vertex_normals()) are smooth but at creases.
/// most_rad  largest angle between the normals of neighbours that is smooth
void split_at_creases(Mesh& mesh, double most_rad);

}  // namespace kiloband
