// Faces of more than three corners, cut into triangles.
#pragma once

#include <span>

#include "scene/mesh/input.hpp"
#include "scene/mesh/mesh.hpp"

namespace kiloband {

/// Cuts faces and counts those for which a fan would not do.
class PolygonCutter {
 public:
  /// Triangles of corner numbers, each with the face's winding: a fan around the first corner, as Mitsuba has it,
  /// where none of its triangles lies the other way round than the face as a whole. Otherwise ears are cut off,
  /// seen along the face's mean normal. What has no ear (edges that cross), or is too large for that, stays a fan.
  /// points  at least 3; the result lives until the next call
  const std::vector<std::array<uint32_t, 3>>& cut(std::span<const Vec3f> points);

  /// A warning with the number of faces that should not be fans and are.
  void report(const MeshFile& file, const DiagnosticSink& sink) const;

 private:
  bool cut_ears();
  bool is_ear(size_t at);

  std::vector<std::array<double, 2>> flat_;         // the face, seen against its normal
  std::vector<uint32_t> left_;                      // corners that no ear has taken
  std::vector<std::array<uint32_t, 3>> triangles_;  // of the last face
  uint64_t tests_ = 0;                              // of corners in ears, so far
  size_t crossed_ = 0, abandoned_ = 0;              // fans that should not be: no ears left, no time left
};

}  // namespace kiloband
