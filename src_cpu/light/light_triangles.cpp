#include "src_cpu/light/light_triangles.hpp"

#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/area-inl.hpp"

namespace kiloband::cpu {
namespace {

LightTriangle make_record(const FlatScene& scene, const KbShape& shape, uint32_t triangle) {
  const one_lane::LitTriangle lit = one_lane::make_lit_triangle(
      scene, shape.flags, shape.area, shape.first_triangle, shape.first_cdf, triangle, {true});
  LightTriangle record{};
  put(lit.t.p0, record.corners[0]);
  put(lit.t.p1, record.corners[1]);
  put(lit.t.p2, record.corners[2]);
  put(lit.normal, record.normal);
  record.offset = lit.offset.v;
  record.factor = lit.factor.v;
  return record;
}

}  // namespace

std::vector<LightTriangle> make_light_triangles(const FlatScene& scene, std::size_t most) {
  if (scene.area_cdf.size() > most) return {};
  std::vector<LightTriangle> records(scene.area_cdf.size());
  for (const KbShape& shape : scene.shapes) {
    if (shape.type != KB_SHAPE_MESH || shape.first_cdf == KB_NONE) continue;
    for (uint32_t i = 0; i < shape.triangle_count; ++i)
      records[std::size_t{shape.first_cdf} + i] = make_record(scene, shape, i);
  }
  return records;
}

}  // namespace kiloband::cpu
