// What shading reads of the triangle that a ray has hit, together in one cache line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// A triangle, in the world, m. The normals are those of its shape (flips and mirrors included). Of an instanced mesh the
/// corners are in its own coordinates, and normal and offset are not used.
struct alignas(64) TriangleRecord {
  float corners[3][3];
  uint32_t vertices[3];  // indices of the corners: for vertex normals and texture coordinates
  float normal[3];       // geometric, unit
  float offset;          // how far off it rays begin (ray_offset-inl.hpp)
};
static_assert(sizeof(TriangleRecord) == 64);

/// More triangles than this are read from the arrays of the scene: their records would take more than 1 GiB.
inline constexpr std::size_t kMostTriangleRecords = std::size_t{1} << 24;

/// In the order of FlatScene::triangles; none for scenes with more than `most` triangles.
std::vector<TriangleRecord> make_triangle_records(const FlatScene& scene,
                                                  std::size_t most = kMostTriangleRecords);

}  // namespace kiloband::cpu
