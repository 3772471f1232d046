#include "scene/optics/coating.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <thread>

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

/// A coating takes 60 to 100 ms of one thread. Neighbours take about as long as each other: none of the parts gets them all.
Coating make_coating(const KbMaterial& material) {
  constexpr std::size_t kStride = 37;  // no divisor in common with their number
  static_assert(std::gcd(kStride, KB_COAT_NODES) == 1);
  const Facets facets(material);
  std::array<Node, KB_COAT_NODES> nodes;
  const unsigned threads = std::max(std::thread::hardware_concurrency(), 1u);
  deal_ranges(nodes.size(), threads, [&](std::size_t first, std::size_t end) {
    for (std::size_t at = first; at < end; ++at) {
      const std::size_t i = at * kStride % nodes.size();
      nodes[i] = node_of(facets, material.eta, i);
    }
  });
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
