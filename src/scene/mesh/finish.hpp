// What every mesh reader does last: the checks and the normals that all formats share.
#pragma once

#include <glm/glm.hpp>

#include "scene/mesh/input.hpp"
#include "scene/mesh/mesh.hpp"

namespace kiloband {

inline glm::dvec3 to_glm(const Vec3f& v) {
  return {v[0], v[1], v[2]};
}

/// The cross product of two edges of a triangle: twice its area along its normal.
inline glm::dvec3 double_area_of(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return glm::cross(to_glm(b) - to_glm(a), to_glm(c) - to_glm(a));
}

/// Normalises mesh.normals and replaces zero vectors by those of compute_vertex_normals().
/// returns how many were replaced
size_t repair_vertex_normals(Mesh& mesh);

/// Checks the triangles' areas, splits vertices at creases where the options say so, then drops, computes or repairs vertex normals as mesh.hpp states. Indices
/// must be in range.
/// throws InputError  no triangle, or none with an area
void finish_mesh(Mesh& mesh, const MeshFile& file, const MeshOptions& options, const DiagnosticSink& sink);

}  // namespace kiloband
