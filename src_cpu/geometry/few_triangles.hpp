// Scenes of few triangles: every ray is tried against all of them, a vector of rays at a time, without a tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// More triangles than this are Embree's (measured: validation/README.md). The number alone decides, so that images do not depend on
/// the machine.
inline constexpr std::size_t kMostFewTriangles = 128;
/// Each triangle may have corners of its own.
inline constexpr std::size_t kMostFewCorners = 3 * kMostFewTriangles;

struct FewTriangles {
  struct Triangle {
    float normal[3];      // unit, along (p1 - p0) x (p2 - p0)
    float inverse_area2;  // 1 / length of that product, 1/m^2
    uint32_t corners[3];  // in `corners`
    uint32_t shape, primitive;
  };
  std::vector<KbFloat3>
      corners;  // m; places that triangles share stand once, so that edges they share are the same to a ray
  std::vector<Triangle> triangles;  // without those that have no area
};

/// Nothing for scenes that have more triangles than `most`, or none, or something else to be hit, or null boundaries, behind which rays go
/// their own ways.
std::optional<FewTriangles> find_few_triangles(const FlatScene& scene, std::size_t most = kMostFewTriangles);

}  // namespace kiloband::cpu
