#include "src_cpu/bsdf/rough_transmittance.hpp"

#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "base/gauss_legendre.hpp"
#include "src_cpu/bsdf/fresnel.hpp"
#include "src_cpu/bsdf/microfacet.hpp"

namespace kiloband {
namespace {

struct Quadrature {
  std::vector<float> nodes, weights;  // on [0, 1]
};

Quadrature unit_quadrature(int n) {
  const GaussLegendre rule = gauss_legendre(n);
  Quadrature q;
  for (const double x : rule.nodes) q.nodes.push_back(static_cast<float>(0.5 * (1 + x)));
  for (const double w : rule.weights) q.weights.push_back(static_cast<float>(0.5 * w));
  return q;
}

/// Mean over visible normals of F or 1 - F times the masking of where the light goes: what a rough boundary
/// reflects or transmits of light from wi (wi.z > 0) in single scattering. eta: far over near index.
double scattered_fraction(const Microfacet& facets, glm::vec3 wi, float eta, bool transmit,
                          const Quadrature& q) {
  double sum = 0;
  for (std::size_t i = 0; i < q.nodes.size(); ++i) {
    for (std::size_t j = 0; j < q.nodes.size(); ++j) {
      const glm::vec3 m = facets.sample_normal(wi, {q.nodes[i], q.nodes[j]});
      const float dot_i = std::clamp(glm::dot(wi, m), 0.0f, 1.0f);
      const DielectricFresnel f = fresnel_dielectric(dot_i, eta);
      glm::vec3 wo = transmit ? refract_at(wi, m, f.cos_t, eta) : reflect_at(wi, m);
      if (transmit) wo.z = -wo.z;
      if (!(wo.z > 0)) continue;
      const float share = transmit ? 1 - f.reflectance : f.reflectance;
      sum += static_cast<double>(q.weights[i] * q.weights[j]) * share * facets.masking(wo);
    }
  }
  return sum;
}

}  // namespace

RoughTransmittance make_rough_transmittance(const KbMaterial& material) {
  const Microfacet facets(material.distribution == KB_MICROFACET_GGX, material.alpha_u, material.alpha_u,
                          true);
  // From inside the integrand has the edge of total internal reflection: more nodes.
  const Quadrature outside = unit_quadrature(32), inside = unit_quadrature(64);
  RoughTransmittance table;
  double internal = 0;
  for (int i = 0; i < RoughTransmittance::kNodes; ++i) {
    const float mu = std::max(1e-6f, static_cast<float>(i) / (RoughTransmittance::kNodes - 1));
    const glm::vec3 wi(std::sqrt(1 - mu * mu), 0, mu);
    const double t = scattered_fraction(facets, wi, material.eta, true, outside);
    table.external[i] = static_cast<float>(std::clamp(t, 0.0, 1.0));
    internal += mu * scattered_fraction(facets, wi, 1 / material.eta, false, inside);
  }
  table.internal_reflectance = static_cast<float>(2 * internal / RoughTransmittance::kNodes);
  return table;
}

}  // namespace kiloband
