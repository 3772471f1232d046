// Triangle meshes under construction, and what turns them into meshes fit for rendering.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scenes/generator/vec.hpp"

namespace kiloband::generator {

/// Lengths in metres. normals: empty, or one unit vector per position. uvs: empty, or one per position.
struct Mesh {
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs;
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// The meshes of a scene by name: "table_top" becomes meshes/table_top.ply.
using Parts = std::map<std::string, Mesh>;

/// Adds b to a. Both have normals or neither; where only one has uvs, the other gets (0, 0).
void append(Mesh& a, const Mesh& b);
/// A mirroring frame turns the triangles round, so that outside stays outside.
Mesh transformed(const Mesh& mesh, const Frame& frame);
/// Moves every position; before normals are made.
void deform(Mesh& mesh, const std::function<Vec3(Vec3)>& map);
/// Turns all triangles round.
void flip(Mesh& mesh);
/// Six times the volume that a closed mesh encloses; negative if its triangles look inwards.
double signed_volume6(const Mesh& mesh);

/// Sets vertex normals: at each corner the area-weighted mean over the adjacent triangles whose normal is
/// within `crease_degrees` of the corner's own. Vertices at equal positions count as one,
/// and are split where normals differ.
Mesh with_smooth_normals(const Mesh& mesh, double crease_degrees);

/// uv = (position . u, position . v): textures in metres.
void project_uvs(Mesh& mesh, Vec3 u, Vec3 v);

/// Rounds to single precision and drops triangles that this makes a line or a point. Requires normals.
Mesh in_single_precision(const Mesh& mesh);

/// Binary little-endian PLY: x y z nx ny nz and, if there are any, u v.
/// throws std::runtime_error  cannot be written
void write_ply(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace kiloband::generator
