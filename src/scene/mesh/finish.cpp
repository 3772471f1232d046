#include "scene/mesh/finish.hpp"

#include <algorithm>

#include "scene/mesh/creases.hpp"

namespace kiloband {
namespace {

// Exact enough: the difference of two floats is nearly always exact in double,
// and nothing under- or overflows.
bool has_zero_area(const Mesh& mesh, const std::array<uint32_t, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  return double_area_of(mesh.positions[a], mesh.positions[b], mesh.positions[c]) == glm::dvec3(0);
}

void check_areas(const Mesh& mesh, const MeshFile& file, const DiagnosticSink& sink) {
  const size_t total = mesh.triangles.size();
  if (total == 0) file.fail("the mesh has no triangles");
  const auto flat = static_cast<size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                                                      [&](const auto& t) { return has_zero_area(mesh, t); }));
  const std::string of_all = " of " + std::to_string(total) + " triangles ";
  if (flat == total) file.fail(std::to_string(flat) + of_all + "have zero area: nothing is left to render");
  if (flat > 0)
    warn(sink, {file.name}, std::to_string(flat) + of_all + (flat == 1 ? "has" : "have") + " zero area");
}

}  // namespace

void finish_mesh(Mesh& mesh, const MeshFile& file, const MeshOptions& options, const DiagnosticSink& sink) {
  check_areas(mesh, file, sink);
  if (options.max_smooth_angle && !options.face_normals) split_at_creases(mesh, *options.max_smooth_angle);
  if (options.face_normals) {
    mesh.normals.clear();
  } else if (mesh.normals.empty()) {
    compute_vertex_normals(mesh);
  } else {
    mesh.front_by_normals = true;
    const size_t replaced = repair_vertex_normals(mesh);
    if (replaced == 0) return;
    warn(sink, {file.name},
         std::to_string(replaced) + " of " + std::to_string(mesh.normals.size()) +
             " vertex normals are missing or zero: computed from the triangles");
  }
}

}  // namespace kiloband
