// Albedos of microfacet materials in single scattering, in double precision: what emission and energy
// compensation are made of.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shared/records.h"

namespace kiloband {

/// The distribution of normals of a rough material. v, m: unit vectors of the local frame, z = surface
/// normal, v.z >= 0.
struct Facets {
  bool ggx = false;
  double alpha_u = 0.1, alpha_v = 0.1;

  explicit Facets(const KbMaterial& material);
  Facets(bool is_ggx, double u, double v) : ggx(is_ggx), alpha_u(u), alpha_v(v) {}

  /// Smith's masking G1(v) / v.z, finite at v.z = 0. Source: Walter et al. 2007, Heitz 2014.
  double masking_over_cos(const glm::dvec3& v) const;
  double masking(const glm::dvec3& v) const;
};

/// Albedos have an error below 2e-5 with this many nodes.
inline constexpr int kFacetNodes = 32;

/// Facets as seen from one direction: normals with weights that sum to 1.
struct VisibleFacet {
  glm::dvec3 normal;
  double weight;
};

/// A quadrature of the density of visible normals D(m) G1(v) max(v.m, 0) / v.z dm (Heitz 2014), by
/// Gauss-Legendre rules in variables in which it is smooth, between the lines where reflection and, towards
/// the relative index eta, transmission begin and end.
/// eta    far over near index; 1: a mirror, which only reflects
/// nodes  in each piece, towards the view and across it
std::vector<VisibleFacet> visible_facets(const Facets& facets, const glm::dvec3& v, double eta = 1,
                                         int nodes = kFacetNodes);

/// Unpolarised Fresnel reflectance; eta: far over near index; 1 beyond the critical angle. cos_i in [0, 1]
double dielectric_reflectance(double cos_i, double eta);
/// 1 - F of a metal of index n - i k for light from vacuum, without cancellation.
double metal_absorptance(double cos_i, double n, double k);

/// Part of the light from v that leaves on either side.
struct Albedo {
  double reflected = 0, transmitted = 0;
};
/// Facets that reflect everything.
double mirror_albedo(const Facets& facets, const glm::dvec3& v, int nodes = kFacetNodes);
/// A rough boundary, or the coating of a rough plastic; without the 1 / eta^2 of radiance.
/// eta  far over near index
Albedo boundary_albedo(const Facets& facets, const glm::dvec3& v, double eta, int nodes = kFacetNodes);

/// The direction at a position of the compensation tables' grid: x, s in [0, 1] (shared/thermal.h), of
/// dielectrics or others.
glm::dvec3 compensation_direction(const Facets& facets, double x, double s, bool dielectric);

}  // namespace kiloband
