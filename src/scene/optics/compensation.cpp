#include "scene/optics/compensation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/deal_ranges.hpp"
#include "scene/optics/facet_quadrature.hpp"
#include "shared/material_tables.h"
#include "shared/thermal.h"

namespace kiloband {
namespace {

constexpr int kIndexNodes = 9;

bool transmits(const KbMaterial& material) {
  return material.type == KB_MATERIAL_ROUGH_DIELECTRIC;
}

using DirectionFunction = std::function<double(const glm::dvec3&)>;

/// Appends f over the grid of (x, s) whose directions are direction(x, s). Each node takes about a millisecond.
void append_nodes(uint32_t nodes_s, const std::function<glm::dvec3(double, double)>& direction,
                  const DirectionFunction& f, std::vector<float>& out) {
  const std::size_t before = out.size();
  out.resize(before + std::size_t{nodes_s} * KB_COMPENSATION_NODES);
  deal_items(out.size() - before, [&](std::size_t node) {
    const double s = nodes_s > 1 ? static_cast<double>(node / KB_COMPENSATION_NODES) / (nodes_s - 1) : 0;
    const double x = static_cast<double>(node % KB_COMPENSATION_NODES) / (KB_COMPENSATION_NODES - 1);
    out[before + node] = static_cast<float>(f(direction(x, s)));
  });
}

/// Of energy compensation.
void append_grid(const KbMaterial& material, const DirectionFunction& f, std::vector<float>& out) {
  const Facets facets(material);
  append_nodes(
      nodes_of_s(material),
      [&](double x, double s) { return compensation_direction(facets, x, s, transmits(material)); }, f, out);
}

/// Of the reflected part, whose x is kb_reflected_position(); eta: far over near index.
void append_reflected_grid(const KbMaterial& material, double eta, const DirectionFunction& f,
                           std::vector<float>& out) {
  const Facets facets(material);
  const double critical = eta < 1 ? std::sqrt(1 - eta * eta) : 0, start = eta < 1 ? 0.5 : 0;
  const auto direction = [&](double x, double s) {
    const double t = x < start ? 1 - x / start : (x - start) / (1 - start);
    const double cosine = x < start ? critical * (1 - t * t) : critical + (1 - critical) * t * t;
    const glm::dvec3 grazing = compensation_direction(facets, 0, s, transmits(material));
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return glm::dvec3(sine * grazing.x, sine * grazing.y, cosine);
  };
  append_nodes(nodes_of_s(material), direction, f, out);
}

/// Of anisotropic dielectrics, whose tables are coarse in s anyway, with fewer nodes: seconds are at stake.
Albedo table_albedo(const KbMaterial& material, const Facets& facets, const glm::dvec3& v, double eta) {
  return boundary_albedo(facets, v, eta, is_anisotropic(material) ? kFacetNodes / 2 : kFacetNodes);
}

double scattered(const KbMaterial& material, const Facets& facets, const glm::dvec3& v, double eta) {
  const Albedo albedo = table_albedo(material, facets, v, eta);
  return albedo.reflected + albedo.transmitted;
}

}  // namespace

std::vector<float> make_compensation_table(const KbMaterial& material, const IndexRange& index) {
  const Facets facets(material);
  if (!transmits(material)) {
    std::vector<float> table{static_cast<float>(nodes_of_s(material)), 1, 0, 0};
    append_grid(
        material, [&](const glm::dvec3& v) { return mirror_albedo(facets, v); }, table);
    return table;
  }
  const int nodes = index.max > index.min ? kIndexNodes : 1;
  const double step = nodes > 1 ? (index.max - index.min) / (nodes - 1) : 0;
  std::vector<float> table{static_cast<float>(nodes_of_s(material)), static_cast<float>(nodes),
                           static_cast<float>(index.min), static_cast<float>(step > 0 ? 1 / step : 0)};
  for (const bool inside : {false, true}) {
    for (int i = 0; i < nodes; ++i) {
      const double eta = index.min + i * step;
      append_grid(
          material,
          [&](const glm::dvec3& v) { return scattered(material, facets, v, inside ? 1 / eta : eta); }, table);
    }
  }
  return table;
}

std::vector<float> make_reflected_part(const KbMaterial& material) {
  const Facets facets(material);
  std::vector<float> table;
  if (!transmits(material)) {
    append_reflected_grid(
        material, material.eta,
        [&](const glm::dvec3& v) {
          return boundary_albedo(facets, v, material.eta).reflected / mirror_albedo(facets, v);
        },
        table);
    return table;
  }
  for (const double eta : {double{material.eta}, 1.0 / material.eta}) {
    append_reflected_grid(
        material, eta,
        [&](const glm::dvec3& v) {
          const Albedo albedo = table_albedo(material, facets, v, eta);
          return albedo.reflected / (albedo.reflected + albedo.transmitted);
        },
        table);
  }
  return table;
}

// The base scatters T(wi) T(wo) cos_o / (pi eta^2 (1 - R_int)); over all wo that is T(wi) q with q = 2 int
// T(c) c dc / (eta^2 (1 - R_int)), T linear between its nodes.
std::vector<float> make_coat_part(const Coating& coating, double eta) {
  const std::vector<float>& t = coating.transmittance;
  const double step = 1.0 / (KB_COAT_NODES - 1);
  double sum = 0;
  for (int i = 0; i + 1 < KB_COAT_NODES; ++i) {
    const double low = i * step, high = low + step;
    sum += step / 3 * (t[i] * (2 * low + high) / 2 + t[i + 1] * (low + 2 * high) / 2) * 2;
  }
  const double q = sum / (eta * eta * (1 - coating.internal_reflectance));
  std::vector<float> table;
  for (const float value : t) table.push_back(static_cast<float>(value * q));
  return table;
}

}  // namespace kiloband
