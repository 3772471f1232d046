#include "scene/read/primitives.hpp"

namespace kiloband {
namespace {

using Corners = std::array<Vec3f, 4>;

/// A face with vertices of its own.
void add_quad(Mesh& mesh, const Corners& corners, const std::array<Vec2f, 4>& uvs) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), corners.begin(), corners.end());
  mesh.uvs.insert(mesh.uvs.end(), uvs.begin(), uvs.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

Mesh make_rectangle() {
  Mesh mesh;
  mesh.front_by_normals = true;
  add_quad(mesh, {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}});
  return mesh;
}

Mesh make_cube() {
  // Counter-clockwise from outside.
  constexpr Corners kFaces[] = {{{{1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}}},
                                {{{1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}}},
                                {{{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}},
                                {{{1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}}},
                                {{{-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}}},
                                {{{1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}}}};
  Mesh mesh;
  mesh.front_by_normals = true;
  for (const Corners& face : kFaces) add_quad(mesh, face, {{{0, 1}, {1, 1}, {1, 0}, {0, 0}}});
  return mesh;
}

}  // namespace kiloband
