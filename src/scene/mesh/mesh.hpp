// Triangle meshes and their readers (OBJ, PLY, STL, Mitsuba serialized): our own, small and strict.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"

namespace kiloband {

using Vec3f = std::array<float, 3>;
using Vec2f = std::array<float, 2>;

/// Indexed triangles, counter-clockwise seen from outside. normals (unit length) and uvs are empty or one per
/// position. Vertex normals, where there are any, say which side is the front, whatever the winding.
struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<Vec2f> uvs;
  std::vector<std::array<uint32_t, 3>> triangles;
  /// What a mirroring transform does to the front. true: takes it along, since it was given by normals: a
  /// file's vertex normals, or those that rectangles and cubes have by definition. false: it follows from the
  /// winding, and so do computed vertex normals: the mirrored triangles show the other side. Mitsuba's rule.
  bool front_by_normals = false;
  /// Every further vertex property of a PLY file by name ("temperature", "red" ...), one value per position.
  std::map<std::string, std::vector<float>> vertex_attributes;
  /// The same of its faces, one value per triangle: a polygon's for each of its triangles. Triangle strips have none.
  std::map<std::string, std::vector<float>> face_attributes;
  /// Which of them the file has in bytes, 0 to 255: "vertex red", "face red".
  std::set<std::string> byte_attributes;
};

struct MeshOptions {
  bool face_normals = false;     // drop vertex normals: shading uses the geometric normal
  bool flip_tex_coords = false;  // v = 1 - v (the reader passes each format's default)
  int shape_index = 0;           // serialized only
  /// rad. Vertex normals of the file are dropped, and computed ones are smooth where neighbours' normals are at most this
  /// far apart (creases.hpp). Not for STL; nothing where face_normals is set.
  std::optional<double> max_smooth_angle;
};

// All readers check everything against the file's size before they allocate, accept only finite numbers and
// indices in range, and drop no triangle. Polygons are split into a fan around their first corner, as Mitsuba
// does, or where that would fold by cutting ears off (polygon.hpp). Common to all of them:
// - zero-area triangles are reported once per file with their count as a warning; a mesh without a triangle
//   of positive area is an error (area: the cross product of two edges in double precision, compared with 0);
// - OBJ, PLY and serialized meshes without vertex normals get compute_vertex_normals() unless face_normals is
//   set: the rule of Mitsuba 3 for all three (its src/shapes/{obj,ply,serialized}.cpp). STL never has vertex
//   normals;
// - vertex normals of the file are normalised; missing ones (OBJ) and zero vectors are computed instead, one
//   warning.
// throws InputError  "file: ...", "file:line: ..." for text, "file: byte N: ..." (0-based) for binary data

/// Wavefront OBJ. Lines read: v (x y z, further numbers such as w or r g b are checked and ignored), vt (u v
/// [w]), vn, f; ignored: empty, #, mtllib, usemtl (a note if there are several), g, o, s, l, p; any other keyword is an error. Indices
/// refer to lines above and start at 1; relative (negative) ones are refused, as by Mitsuba. A vertex is a
/// distinct index tuple (position, uv, normal), in order of first use: equal positions on different lines are
/// never merged, so neither are normals smoothed over them.
Mesh read_obj(const std::filesystem::path& file, const MeshOptions& options, const DiagnosticSink& sink = {});

/// PLY 1.0: ascii, binary_little_endian, binary_big_endian, every scalar type by its old and new name.
/// Element vertex: x y z, nx ny nz, texture coordinates u v or texture_u texture_v or s t, the rest goes to
/// vertex_attributes (lists are skipped with a note). Element face: list vertex_indices or vertex_index, numbers go to face_attributes; list
/// texcoord, two numbers for each corner, takes the place of the vertices' texture coordinates (corner_uvs.hpp). Element
/// tristrips: the same list
/// of triangle strips one after another, -1 between them. Other elements are skipped with a note.
Mesh read_ply(const std::filesystem::path& file, const MeshOptions& options, const DiagnosticSink& sink = {});

/// STL, ascii or binary. Vertices are not welded: every triangle has three of its own. No vertex normals, no
/// uv; the stored facet normals are not looked at, the order of the corners counts.
Mesh read_stl(const std::filesystem::path& file, const MeshOptions& options, const DiagnosticSink& sink = {});

/// Mitsuba's serialized format, versions 3 and 4: mesh number options.shape_index of the file. Its flag "face
/// normals" acts like options.face_normals; vertex colours are skipped.
Mesh read_serialized(const std::filesystem::path& file, const MeshOptions& options,
                     const DiagnosticSink& sink = {});

/// Sets mesh.normals: the sum of the adjacent triangles' normals weighted by their angles at the vertex. Sums
/// over vertex INDICES, so coincident vertices stay apart. Where the sum vanishes, the normal of an adjacent
/// triangle is taken; where no triangle has an area, (0, 0, 1).
/// Source: Thürmer, Wüthrich, Computing vertex normals from polygonal facets, JGT 3(1), 1998 (Mitsuba's
/// choice too).
void compute_vertex_normals(Mesh& mesh);

/// The columns of a linear map.
using LinearMap = std::array<std::array<double, 3>, 3>;

/// What compute_vertex_normals() gives for the mesh with all positions mapped: where angles change or the map
/// mirrors, not its image of the normals.
std::vector<Vec3f> mapped_vertex_normals(const Mesh& mesh, const LinearMap& to_world);

/// Triangles whose vertex normals' sum points against their winding.
size_t count_opposed_triangles(const Mesh& mesh);

}  // namespace kiloband
