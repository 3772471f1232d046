#include "scene/read/primitives.hpp"

namespace kiloband {
namespace {

/// Appends the quad centre +- u +- v with corners counter-clockwise about u x v; uv (0,0) at centre - u - v.
void add_quad(Mesh& mesh, const Vec3f& centre, const Vec3f& u, const Vec3f& v) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  constexpr float kSigns[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (const auto& [s, t] : kSigns) {
    mesh.positions.push_back(
        {centre[0] + s * u[0] + t * v[0], centre[1] + s * u[1] + t * v[1], centre[2] + s * u[2] + t * v[2]});
    mesh.uvs.push_back({(s + 1) / 2, (t + 1) / 2});
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

Mesh make_rectangle() {
  Mesh mesh;
  mesh.front_by_normals = true;
  add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  return mesh;
}

Mesh make_cube() {
  Mesh mesh;
  mesh.front_by_normals = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3f n{0, 0, 0}, u{0, 0, 0}, v{0, 0, 0};
    n[axis] = u[(axis + 1) % 3] = v[(axis + 2) % 3] = 1;
    add_quad(mesh, n, u, v);
    const Vec3f opposite{-n[0], -n[1], -n[2]};
    add_quad(mesh, opposite, v, u);
  }
  return mesh;
}

}  // namespace kiloband
