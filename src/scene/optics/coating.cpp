#include "scene/optics/coating.hpp"

#include <algorithm>
#include <cmath>

#include "scene/optics/facet_quadrature.hpp"

namespace kiloband {

Coating make_coating(const KbMaterial& material) {
  const Facets facets(material);
  const double eta = material.eta;
  Coating coating;
  double internal = 0;
  for (int i = 0; i < KB_COAT_NODES; ++i) {
    const double cosine = std::max(1e-6, static_cast<double>(i) / (KB_COAT_NODES - 1));
    const glm::dvec3 v(std::sqrt(1 - cosine * cosine), 0, cosine);
    const double through = boundary_albedo(facets, v, eta).transmitted;
    coating.transmittance.push_back(static_cast<float>(std::clamp(through, 0.0, 1.0)));
    internal += cosine * boundary_albedo(facets, v, 1 / eta).reflected;
  }
  coating.internal_reflectance = 2 * internal / KB_COAT_NODES;
  return coating;
}

}  // namespace kiloband
