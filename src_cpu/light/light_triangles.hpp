// What light samples read of the triangles of area lights, together in one cache line.
#pragma once

#include <cstddef>
#include <vector>

#include "scene/compile/flat_scene.hpp"

namespace kiloband::cpu {

/// A triangle of an area light, in the world, m. Its normal is that of its shape (flips and mirrors included).
struct alignas(64) LightTriangle {
  float corners[3][3];
  float normal[3];  // geometric, unit
  float offset;     // how far off it rays begin (ray_offset-inl.hpp)
  float factor;     // AreaSample::factor (area-inl.hpp)
  float unused[2];
};
static_assert(sizeof(LightTriangle) == 64);

/// Scenes whose lights have more triangles do without: their records would take more than 1 GiB.
inline constexpr std::size_t kMostLightTriangles = std::size_t{1} << 24;

/// Triangle i of a shape is number first_cdf + i; none for scenes with more than `most`.
std::vector<LightTriangle> make_light_triangles(const FlatScene& scene,
                                                std::size_t most = kMostLightTriangles);

}  // namespace kiloband::cpu
