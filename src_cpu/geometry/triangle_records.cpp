#include "src_cpu/geometry/triangle_records.hpp"

#include <algorithm>

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/geometry/surface_hit-inl.hpp"

namespace kiloband::cpu {
namespace {

TriangleRecord make_record(const FlatScene& scene, const KbShape& shape, const uint32_t* vertices) {
  const one_lane::U index[3] = {vertices[0], vertices[1], vertices[2]};
  const one_lane::Triangle triangle = one_lane::gather_triangle(scene, index);
  const one_lane::V3 normal = one_lane::triangle_normal(triangle, shape.flags, {true});
  TriangleRecord record;
  put(triangle.p0, record.corners[0]);
  put(triangle.p1, record.corners[1]);
  put(triangle.p2, record.corners[2]);
  std::copy_n(vertices, 3, record.vertices);
  put(normal, record.normal);
  record.offset = one_lane::surface_offset(one_lane::largest_coordinates(triangle), normal).v;
  return record;
}

}  // namespace

std::vector<TriangleRecord> make_triangle_records(const FlatScene& scene, std::size_t most) {
  const std::size_t count = scene.triangles.size() / 3;
  if (count > most) return {};
  std::vector<TriangleRecord> records(count);
  std::size_t done = 0;  // triangles of shapes stand in their order
  for (const KbShape& shape : scene.shapes) {
    if (shape.type != KB_SHAPE_MESH) continue;
    const std::size_t first = shape.first_triangle, end = first + shape.triangle_count;
    if (first < done) continue;  // of an instance, where the group's first instance was met already
    done = end;
    for (std::size_t i = first; i < end; ++i) records[i] = make_record(scene, shape, &scene.triangles[3 * i]);
  }
  return records;
}

}  // namespace kiloband::cpu
