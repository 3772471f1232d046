#include "src_cpu/light/thermal.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "shared/material_tables.h"
#include "shared/thermal.h"
#include "src_cpu/geometry/texture/texture_lookup.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that they are to be compiled for.
#include "src_cpu/bsdf/fresnel-inl.hpp"
#include "src_cpu/geometry/texture/texture-inl.hpp"
#include "src_cpu/light/area-inl.hpp"

namespace kiloband::cpu {
namespace {

/// Where a direction lies in the tables of a record.
struct Aspect {
  float cosine;  // in [0, 1]
  float s;       // shared/thermal.h
  bool below;
};

Aspect aspect_of(const KbThermal& thermal, glm::vec3 w) {
  const bool glass = thermal.flags & KB_THERMAL_TRANSMITS;
  const float px = (glass ? std::sqrt(std::sqrt(thermal.alpha_u)) : thermal.alpha_u) * w.x;
  const float py = (glass ? std::sqrt(std::sqrt(thermal.alpha_v)) : thermal.alpha_v) * w.y;
  const float sum = px * px + py * py;
  return {std::min(std::abs(w.z), 1.0f), sum > 0 ? py * py / sum : 0, w.z < 0};
}

/// Linear between equidistant nodes; position in units of nodes.
float interpolated(const float* nodes, uint32_t count, float position) {
  const auto i = std::min(static_cast<uint32_t>(position), count - 2);
  const float t = position - static_cast<float>(i);
  return nodes[i] + t * (nodes[i + 1] - nodes[i]);
}

/// One of two neighbours, with the weights of linear interpolation.
uint32_t choose_node(float position, uint32_t count, float u) {
  const auto i = std::min(static_cast<uint32_t>(position), count - 2);
  return u < position - static_cast<float>(i) ? i + 1 : i;
}

uint32_t row_of_nodes(const FlatScene& scene, const KbThermal& thermal, const Aspect& aspect, glm::vec2 u) {
  const float* cosines = &scene.tables[thermal.table];
  const uint32_t below = std::min(one_lane::find_interval(cosines, 0, thermal.nodes_cos, aspect.cosine).v,
                                  thermal.nodes_cos - 2);
  const float t = (aspect.cosine - cosines[below]) / (cosines[below + 1] - cosines[below]);
  const uint32_t i = u.x < t ? below + 1 : below;
  uint32_t j = 0;
  if (thermal.nodes_s > 1)
    j = choose_node(aspect.s * static_cast<float>(thermal.nodes_s - 1), thermal.nodes_s, u.y);
  return thermal.first_row + i + thermal.nodes_cos * j;
}

/// The reflected part R of KB_THERMAL_ROUGH; eta: far over near index.
float reflected_part(const KbThermal& thermal, const float* table, const Aspect& aspect, float eta) {
  const bool inside = aspect.below && (thermal.flags & KB_THERMAL_TRANSMITS);
  const float position = kb_reflected_position(aspect.cosine, eta) * (KB_COMPENSATION_NODES - 1);
  const float* rows = table + (inside ? thermal.nodes_s * KB_COMPENSATION_NODES : 0);
  if (thermal.nodes_s == 1) return interpolated(rows, KB_COMPENSATION_NODES, position);
  const float s = aspect.s * static_cast<float>(thermal.nodes_s - 1);
  const auto j = std::min(static_cast<uint32_t>(s), thermal.nodes_s - 2);
  const float low = interpolated(rows + j * KB_COMPENSATION_NODES, KB_COMPENSATION_NODES, position);
  const float high = interpolated(rows + (j + 1) * KB_COMPENSATION_NODES, KB_COMPENSATION_NODES, position);
  return low + (s - static_cast<float>(j)) * (high - low);
}

/// c_0 .. c_2 of KB_THERMAL_SMOOTH and _ROUGH.
void coefficients(const FlatScene& scene, const KbThermal& thermal, const Aspect& aspect, float (&c)[3]) {
  const bool transmits = thermal.flags & KB_THERMAL_TRANSMITS;
  const float* table = thermal.table == KB_NONE ? nullptr : &scene.tables[thermal.table];
  const float eta = aspect.below && transmits ? 1 / thermal.eta : thermal.eta;
  c[0] = table ? reflected_part(thermal, table, aspect, eta)
               : one_lane::fresnel_dielectric(aspect.cosine, eta).reflectance.v;
  if (thermal.flags & KB_THERMAL_THIN) c[0] = 2 * c[0] / (1 + c[0]);
  if (transmits) {
    const float scale = aspect.below ? thermal.eta * thermal.eta : 1;
    c[1] = scale * (1 - c[0]);
    c[0] *= scale;
    c[2] = 0;
    return;
  }
  c[1] = thermal.q * (1 - c[0]);
  if (table) c[1] = kb_coat_transmittance(table + thermal.nodes_s * KB_COMPENSATION_NODES, aspect.cosine);
  c[2] = std::max(0.0f, 1 - c[0] - c[1]);
}

/// An emission spectrum and what it is multiplied by.
struct Source {
  uint32_t ref = KB_NONE;
  float weight = 0;
};

Source choose_source(const FlatScene& scene, const KbThermal& thermal, const Aspect& aspect, glm::vec2 u) {
  if (thermal.type == KB_THERMAL_UNIFORM) return {thermal.ref[0], 1};
  if (thermal.type == KB_THERMAL_NODES) return {KB_REF_SPECTRUM | row_of_nodes(scene, thermal, aspect, u), 1};
  float c[3];
  coefficients(scene, thermal, aspect, c);
  float total = 0;
  for (int i = 0; i < 3; ++i) total += thermal.ref[i] == KB_NONE ? 0 : c[i];
  Source source;
  float left = u.x * total;
  for (int i = 0; i < 3; ++i) {
    if (thermal.ref[i] == KB_NONE || !(c[i] > 0)) continue;
    source = {thermal.ref[i], total};
    left -= c[i];
    if (left < 0) break;
  }
  return source;
}

float temperature_at(const FlatScene& scene, const KbThermal& thermal, const SurfaceHit& hit) {
  if (thermal.field != KB_FIELD_VERTEX)
    return one_lane::number_at(scene, {KB_REF_BITMAP | thermal.field}, one_lane::place_at(to_lane(hit.uv)),
                               {0}, {true})
        .v;
  const KbShape& shape = scene.shapes[hit.shape];
  const uint32_t* vertex = &scene.triangles[3 * (std::size_t{shape.first_triangle} + hit.triangle)];
  const auto value = [&](int i) { return scene.tables[uint32_t(thermal.field_offset + vertex[i])]; };
  const float w = 1 - hit.barycentric.x - hit.barycentric.y;
  return w * value(0) + hit.barycentric.x * value(1) + hit.barycentric.y * value(2);
}

uint32_t fraction16(float f) {
  return static_cast<uint32_t>(f * 65535.0f + 0.5f);
}

/// The emissivity's source with the place's temperature.
ResolvedSpectrum with_temperature(const ResolvedSpectrum& emissivity, float temperature_k) {
  KbThermalSample sample{KB_SAMPLE_THERMAL | KB_SAMPLE_ROW | emissivity.row, 0, 0, temperature_k};
  if (emissivity.textured) {
    const KbTextureSample& t = emissivity.texture;
    sample = {KB_SAMPLE_THERMAL | t.texture, t.xy, fraction16(t.fx) | fraction16(t.fy) << 16, temperature_k};
  }
  ResolvedSpectrum emitted;
  emitted.textured = true;
  static_assert(sizeof sample == sizeof emitted.texture);
  std::memcpy(&emitted.texture, &sample, sizeof sample);
  return emitted;
}

}  // namespace

ThermalRadiance thermal_radiance(const FlatScene& scene, const SurfaceHit& hit, glm::vec3 towards,
                                 glm::vec2 u) {
  const TexturePoint at(hit.uv, hit.triangle, hit.barycentric);
  const one_lane::TexturePlace place{to_lane(hit.uv), {hit.triangle}, to_lane(hit.barycentric)};
  one_lane::F left = u.x;
  const one_lane::U chosen =
      one_lane::chosen_surface(scene, scene.shapes[hit.shape].surface, place, left, {true});
  u.x = left.v;
  const KbSurface& surface = scene.surfaces[chosen.v];
  const one_lane::V3 normal = to_lane(hit.shading_normal), away = to_lane(towards);
  const uint32_t index = one_lane::on_front(normal, away).v ? surface.front_thermal : surface.back_thermal;
  if (index == KB_NONE) return {};
  const KbThermal& thermal = scene.thermals[index];
  const bool anisotropic = thermal.alpha_u != thermal.alpha_v;
  const one_lane::Frame frame =
      one_lane::make_frame(normal, to_lane(anisotropic ? hit.tangent : glm::vec3(0)));
  const Source source = choose_source(scene, thermal, aspect_of(thermal, to_glm(frame.to_local(away))), u);
  if (!(source.weight > 0)) return {};
  ThermalRadiance emitted;
  emitted.weight = source.weight * one_lane::opacity_at(scene, chosen, place, {true}).v;
  emitted.radiance = resolve_spectrum(scene, source.ref, at);
  if (thermal.field != KB_NONE)
    emitted.radiance = with_temperature(emitted.radiance, temperature_at(scene, thermal, hit));
  return emitted;
}

}  // namespace kiloband::cpu
