// Targets: the readers of meshes.
#include <algorithm>
#include <cmath>

#include "scene/mesh.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

using MeshReader = Mesh (*)(const std::filesystem::path&, const MeshOptions&, const DiagnosticSink&);

template <std::size_t N>
bool finite(const std::vector<std::array<float, N>>& vectors) {
  return std::all_of(vectors.begin(), vectors.end(), [](const std::array<float, N>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return std::isfinite(x); });
  });
}

/// What mesh.hpp promises of every mesh that a reader returns.
void check(const Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  promise(!mesh.triangles.empty(), "a mesh without triangles");
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t index : triangle) promise(index < vertices, "an index out of range");
  promise(mesh.normals.empty() || mesh.normals.size() == vertices, "not one normal per position");
  promise(mesh.uvs.empty() || mesh.uvs.size() == vertices, "not one uv per position");
  promise(finite(mesh.positions) && finite(mesh.normals) && finite(mesh.uvs), "a number that is not finite");
  for (const Vec3f& n : mesh.normals)
    promise(std::abs(std::hypot(n[0], n[1], n[2]) - 1) < 1e-4, "a normal that is not of unit length");
  for (const auto& [name, values] : mesh.vertex_attributes)
    promise(values.size() == vertices, "not one attribute value per position");
}

void read(const char* name, MeshReader reader, std::string_view bytes) {
  const auto file = scratch_file(name, bytes);
  for (const bool face_normals : {false, true}) {
    for (const int shape_index : {0, 1}) {
      if (shape_index > 0 && reader != read_serialized) continue;
      accept_or_refuse([&] { check(reader(file, {face_normals, !face_normals, shape_index}, {})); });
    }
  }
}

}  // namespace

void obj(std::string_view bytes) {
  read("mesh.obj", read_obj, bytes);
}
void ply(std::string_view bytes) {
  read("mesh.ply", read_ply, bytes);
}
void stl(std::string_view bytes) {
  read("mesh.stl", read_stl, bytes);
}
void serialized(std::string_view bytes) {
  read("mesh.serialized", read_serialized, bytes);
}

}  // namespace kiloband::fuzz
