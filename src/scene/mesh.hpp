// Triangle meshes and their readers (OBJ, PLY, STL, Mitsuba serialized): our own, small and strict.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"

namespace kiloband {

using Vec3f = std::array<float, 3>;
using Vec2f = std::array<float, 2>;

/// Indexed triangles. normals and uvs are empty or one per position.
struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<Vec2f> uvs;
  std::vector<std::array<uint32_t, 3>> triangles;
  /// Every further vertex property of a PLY file by name ("temperature", "red" ...), one value per position.
  std::map<std::string, std::vector<float>> vertex_attributes;
};

struct MeshOptions {
  bool face_normals = false;     // drop vertex normals: shading uses the geometric normal
  bool flip_tex_coords = false;  // v = 1 - v (the reader passes each format's default)
  int shape_index = 0;           // serialized only
};

/// All readers check everything against the file's size before they allocate, accept only finite numbers and indices
/// in range, and drop no triangle; zero-area triangles are reported once per file with their count as a warning,
/// a mesh without a triangle of positive area is an error.
/// throws InputError  "file:line: ..." for text, "file: byte N: ..." for binary data
Mesh read_obj(const std::filesystem::path& file, const MeshOptions& options, const DiagnosticSink& sink = {});
Mesh read_ply(const std::filesystem::path& file, const MeshOptions& options, const DiagnosticSink& sink = {});
Mesh read_stl(const std::filesystem::path& file, const MeshOptions& options, const DiagnosticSink& sink = {});
Mesh read_serialized(const std::filesystem::path& file, const MeshOptions& options, const DiagnosticSink& sink = {});

/// Angle-weighted vertex normals; used by the OBJ reader for files without normals (over index tuples, not positions),
/// as Mitsuba does for meshes without normals unless face_normals is set.
void compute_vertex_normals(Mesh& mesh);

}  // namespace kiloband
