#include "tests/unit/src_gpu/geometry/ray_tester.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "scene/compile/record_vectors.hpp"

namespace kiloband::test {
namespace {

constexpr const char* kKernels = R"(
#include "geometry/bvh.clh"
__kernel void closest(__global const KbBvhNode* nodes, __global const KbPrimitive* primitives,
                      __global const KbShape* shapes, __global const KbRay* rays, __global KbHit* hits,
                      __global kb_u32* faults) {
  const KbRay ray = rays[get_global_id(0)];
  kb_u32 fault = 0;
  hits[get_global_id(0)] = stored_hit(closest_hit(nodes, primitives, shapes, vload3(0, ray.origin), vload3(0, ray.direction),
                                       ray.t_min, ray.t_max, &fault));
  if (fault) atomic_or(faults, fault);
}
__kernel void occluded(__global const KbBvhNode* nodes, __global const KbPrimitive* primitives,
                  __global const KbShape* shapes, __global const KbRay* rays, __global kb_u32* hits,
                  __global kb_u32* faults) {
  const KbRay ray = rays[get_global_id(0)];
  kb_u32 fault = 0;
  hits[get_global_id(0)] = any_hit(nodes, primitives, shapes, vload3(0, ray.origin), vload3(0, ray.direction),
                                   ray.t_max, &fault);
  if (fault) atomic_or(faults, fault);
}
)";

std::string defines(const FlatScene& scene, uint32_t stack) {
  const bool analytic =
      std::ranges::any_of(scene.shapes, [](const KbShape& s) { return s.type != KB_SHAPE_MESH; });
  return "-DKB_SPECIALISED=1 -DKB_BVH_STACK=" + std::to_string(stack) +
         (analytic ? " -DKB_HAS_ANALYTIC_SHAPES=1" : "") +
         (scene.instances.empty() ? "" : " -DKB_HAS_INSTANCES=1");
}

/// The quad a b c d, seen in this order.
void add_quad(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  mesh.add_triangle(a, b, c);
  mesh.add_triangle(a, c, d);
}

/// Vertices on the surface of an (n + 1)^3 lattice, found by their lattice coordinates.
class CubeLattice {
 public:
  CubeLattice(Mesh& mesh, glm::vec3 centre, float half, uint32_t n)
      : mesh_(mesh), centre_(centre), half_(half), n_(n), ids_((n + 1) * (n + 1) * (n + 1), KB_NONE) {}

  uint32_t vertex(glm::uvec3 at) {
    uint32_t& id = ids_[(at.z * (n_ + 1) + at.y) * (n_ + 1) + at.x];
    if (id == KB_NONE) {
      const glm::vec3 unit = glm::vec3(at) * (2.0f / static_cast<float>(n_)) - 1.0f;
      id = mesh_.add(centre_ + half_ * unit);
    }
    return id;
  }
  void add_face(int axis, uint32_t layer) {
    for (uint32_t i = 0; i < n_; ++i) {
      for (uint32_t j = 0; j < n_; ++j) {
        const auto corner = [&](uint32_t di, uint32_t dj) {
          glm::uvec3 at;
          at[axis] = layer;
          at[(axis + 1) % 3] = i + di;
          at[(axis + 2) % 3] = j + dj;
          return vertex(at);
        };
        add_quad(mesh_, corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
      }
    }
  }

 private:
  Mesh& mesh_;
  glm::vec3 centre_;
  float half_;
  uint32_t n_;
  std::vector<uint32_t> ids_;
};

}  // namespace

uint32_t Mesh::add(glm::vec3 position) {
  positions.push_back(position);
  return static_cast<uint32_t>(positions.size() - 1);
}

void Mesh::add_triangle(uint32_t a, uint32_t b, uint32_t c) {
  indices.insert(indices.end(), {a, b, c});
}

void Mesh::add_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
  const uint32_t first = add(a);
  add(b);
  add(c);
  add_triangle(first, first + 1, first + 2);
}

Mesh uv_sphere(glm::vec3 centre, float radius, uint32_t columns, uint32_t rows) {
  Mesh mesh;
  const uint32_t top = mesh.add(centre + glm::vec3(0, 0, radius)),
                 bottom = mesh.add(centre - glm::vec3(0, 0, radius));
  const auto ring = [&](uint32_t row, uint32_t column) { return 2 + (row - 1) * columns + column % columns; };
  for (uint32_t row = 1; row < rows; ++row) {
    const double theta = 3.14159265358979323846 * row / rows;
    for (uint32_t column = 0; column < columns; ++column) {
      const double phi = 2 * 3.14159265358979323846 * column / columns;
      mesh.add(centre + radius * glm::vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                           std::cos(theta)));
    }
  }
  for (uint32_t column = 0; column < columns; ++column) {
    mesh.add_triangle(top, ring(1, column), ring(1, column + 1));
    for (uint32_t row = 1; row + 1 < rows; ++row)
      add_quad(mesh, ring(row, column), ring(row + 1, column), ring(row + 1, column + 1),
               ring(row, column + 1));
    mesh.add_triangle(bottom, ring(rows - 1, column + 1), ring(rows - 1, column));
  }
  return mesh;
}

Mesh grid_cube(glm::vec3 centre, float half, uint32_t n) {
  Mesh mesh;
  CubeLattice lattice(mesh, centre, half, n);
  for (int axis = 0; axis < 3; ++axis) {
    lattice.add_face(axis, 0);
    lattice.add_face(axis, n);
  }
  return mesh;
}

FlatScene empty_scene() {
  FlatScene scene;
  scene.positions.push_back({0, 0, 0});  // the spare vertex at the end
  return scene;
}

void add_mesh(FlatScene& scene, const Mesh& mesh) {
  scene.positions.pop_back();
  const auto base = static_cast<uint32_t>(scene.positions.size());
  KbShape shape{};
  shape.type = KB_SHAPE_MESH;
  shape.first_triangle = static_cast<uint32_t>(scene.triangles.size() / 3);
  shape.triangle_count = static_cast<uint32_t>(mesh.indices.size() / 3);
  for (const glm::vec3& p : mesh.positions) scene.positions.push_back({p.x, p.y, p.z});
  for (const uint32_t index : mesh.indices) scene.triangles.push_back(base + index);
  scene.positions.push_back({0, 0, 0});
  scene.shapes.push_back(shape);
}

void add_analytic(FlatScene& scene, uint32_t type, const glm::mat3& axes, glm::vec3 origin) {
  KbShape shape{};
  shape.type = type;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) shape.to_world[4 * row + column] = axes[column][row];
    shape.to_world[4 * row + 3] = origin[row];
  }
  scene.shapes.push_back(shape);
}

void make_group(FlatScene& scene, const std::vector<glm::dmat4>& to_world) {
  const std::vector<KbShape> members = scene.shapes;
  scene.shapes.clear();
  scene.groups = {{0, static_cast<uint32_t>(members.size())}};
  scene.features.instances = true;
  for (const glm::dmat4& transform : to_world) {
    scene.instances.push_back({0, static_cast<uint32_t>(scene.shapes.size())});
    for (KbShape shape : members) {
      shape.flags |= KB_SHAPE_INSTANCED;
      store_transform(transform, shape.to_world);
      store_transform(glm::inverse(transform), shape.to_object);
      scene.shapes.push_back(shape);
    }
  }
}

KbRay make_ray(glm::vec3 origin, glm::vec3 direction, float t_min, float t_max) {
  return {
      {origin.x, origin.y, origin.z}, t_min, {direction.x, direction.y, direction.z}, t_max, {0, 0, 0}, 0};
}

glm::vec3 random_vector(std::mt19937& random, float low, float high) {
  const auto coordinate = [&] { return low + (high - low) * static_cast<float>(random()) * 0x1p-32f; };
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

glm::vec3 random_direction(std::mt19937& random) {
  for (;;) {
    const glm::vec3 v = random_vector(random, -1, 1);
    const float length = glm::length(v);
    if (length > 0.01f && length <= 1) return v / length;
  }
}

RayTester::RayTester(const FlatScene& scene, uint32_t stack)
    : bvh_(opencl::build_bvh(scene, 2)),
      probe_(kKernels, defines(scene, stack > 0 ? stack : bvh_.stack_entries())),
      nodes_(probe_.upload(bvh_.nodes)),
      primitives_(probe_.upload(bvh_.primitives)),
      shapes_(probe_.upload(scene.shapes)),
      faults_(probe_.upload(std::vector<uint32_t>{0})) {}

std::vector<KbHit> RayTester::closest(const std::vector<KbRay>& rays) {
  const cl::Buffer input = probe_.upload(rays), hits = probe_.upload(std::vector<KbHit>(rays.size()));
  probe_.run("closest", rays.size(), nodes_, primitives_, shapes_, input, hits, faults_);
  return probe_.download<KbHit>(hits, rays.size());
}

std::vector<uint32_t> RayTester::any(const std::vector<KbRay>& rays) {
  const cl::Buffer input = probe_.upload(rays), hits = probe_.upload(std::vector<uint32_t>(rays.size()));
  probe_.run("occluded", rays.size(), nodes_, primitives_, shapes_, input, hits, faults_);
  return probe_.download<uint32_t>(hits, rays.size());
}

uint32_t RayTester::faults() {
  return probe_.download<uint32_t>(faults_, 1)[0];
}

}  // namespace kiloband::test
