// Targets: the readers of meshes.
#include <algorithm>
#include <cmath>

#include "scene/mesh/mesh.hpp"
#include "tests/fuzz/flat_scene_check.hpp"
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

/// The mesh as a lamp, as a reflector by temperature, and under a transformation.
void flatten(const std::string& type, const std::string& file) {
  const std::string mesh = "<shape type='" + type + "'><string name='filename' value='" + file + "'/>";
  const std::string lamp = "<emitter type='area'><spectrum name='radiance' value='1'/></emitter></shape>";
  const std::string heat =
      "<transform name='to_world'><scale x='2' y='-3' z='0.1'/><rotate y='1' "
      "angle='30'/></transform><emitter "
      "type='thermal'><float name='temperature' value='300'/></emitter></shape>";
  for (const std::string& use : {lamp, heat})
    accept_or_refuse([&] { flatten_and_check(mesh + use, {{500, 600, ""}}); });
}

/// type: of the shape, and the file's extension
void read(const std::string& type, MeshReader reader, std::string_view bytes) {
  const std::string name = "mesh." + type;
  const auto file = scratch_file(name, bytes);
  for (const bool face_normals : {false, true}) {
    for (const int shape_index : {0, 1}) {
      if (shape_index > 0 && reader != read_serialized) continue;
      const bool good = accept_or_refuse([&] {
        check(reader(file, {face_normals, !face_normals, shape_index}, {}));
      });
      if (good && !face_normals && shape_index == 0) flatten(type, name);
    }
  }
}

}  // namespace

void obj(std::string_view bytes) {
  read("obj", read_obj, bytes);
}
void ply(std::string_view bytes) {
  read("ply", read_ply, bytes);
}
void stl(std::string_view bytes) {
  read("stl", read_stl, bytes);
}
void serialized(std::string_view bytes) {
  read("serialized", read_serialized, bytes);
}

}  // namespace kiloband::fuzz
