#include "scene/optics/coating.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/deal_ranges.hpp"
#include "scene/optics/facet_quadrature.hpp"

namespace kiloband {
namespace {

struct Node {
  double transmitted = 0, internal = 0;
};

/// Of the i-th of the equidistant cosines: what comes through from outside, and cosine times what is thrown back from inside.
Node node_of(const Facets& facets, double eta, std::size_t i) {
  const double cosine = std::max(1e-6, static_cast<double>(i) / (KB_COAT_NODES - 1));
  const glm::dvec3 v(std::sqrt(1 - cosine * cosine), 0, cosine);
  return {boundary_albedo(facets, v, eta).transmitted,
          cosine * boundary_albedo(facets, v, 1 / eta).reflected};
}

}  // namespace

/// That takes 60 to 100 ms of one thread.
Coating make_coating(const KbMaterial& material) {
  const Facets facets(material);
  std::array<Node, KB_COAT_NODES> nodes;
  deal_items(nodes.size(), [&](std::size_t i) { nodes[i] = node_of(facets, material.eta, i); });
  Coating coating;
  double internal = 0;
  for (const Node& node : nodes) {
    coating.transmittance.push_back(static_cast<float>(std::clamp(node.transmitted, 0.0, 1.0)));
    internal += node.internal;
  }
  coating.internal_reflectance = 2 * internal / KB_COAT_NODES;
  return coating;
}

}  // namespace kiloband
