// Scenes of bare geometry, and their ray queries on the OpenCL device.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "shared/pipeline.h"
#include "src_gpu/geometry/bvh_builder.hpp"
#include "tests/support/opencl_probe.hpp"

namespace kiloband::test {

/// A mesh by vertices and triples of indices.
struct Mesh {
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> indices;

  uint32_t add(glm::vec3 position);
  void add_triangle(uint32_t a, uint32_t b, uint32_t c);
  void add_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c);
};

/// Closed: one vertex at each pole, the seam's vertices are shared. 2 * columns * (rows - 1) triangles;
/// positions are centre + radius * direction, rounded.
Mesh uv_sphere(glm::vec3 centre, float radius, uint32_t columns, uint32_t rows);
/// Closed: six faces of n x n squares with shared vertices; all faces lie in planes of the axes.
Mesh grid_cube(glm::vec3 centre, float half, uint32_t n);

/// A scene of geometry alone.
FlatScene empty_scene();
void add_mesh(FlatScene& scene, const Mesh& mesh);
/// The scene's shapes become a group, which stands where the transforms (row-major 3x4) say.
void make_group(FlatScene& scene, const std::vector<glm::dmat4>& to_world);
/// axes  columns of the linear part
void add_analytic(FlatScene& scene, uint32_t type, const glm::mat3& axes, glm::vec3 origin);

KbRay make_ray(glm::vec3 origin, glm::vec3 direction, float t_min = 0, float t_max = INFINITY);
glm::vec3 random_vector(std::mt19937& random, float low, float high);
glm::vec3 random_direction(std::mt19937& random);

/// Builds the scene's hierarchy and runs queries.
class RayTester {
 public:
  /// stack  entries; 0: what the depth needs
  explicit RayTester(const FlatScene& scene, uint32_t stack = 0);

  std::vector<KbHit> closest(const std::vector<KbRay>& rays);
  /// 1: something is hit. t_min is not used: the interval is (0, t_max).
  std::vector<uint32_t> any(const std::vector<KbRay>& rays);
  /// KB_FAULT_* of all queries so far.
  uint32_t faults();
  const opencl::Bvh& bvh() const { return bvh_; }

 private:
  opencl::Bvh bvh_;
  OpenclProbe probe_;
  cl::Buffer nodes_, primitives_, shapes_, faults_;
};

}  // namespace kiloband::test
