// Independent double-precision versions of what src_cpu computes, written from the textbook forms (tangents,
// slopes, complex refraction) and integrated over slopes instead of directions.
#pragma once

#include <functional>
#include <glm/glm.hpp>

namespace kiloband::reference {

using Vec = glm::dvec3;

/// Unpolarised Fresnel reflectance by complex long double arithmetic; eta transmitted over incident.
long double fresnel(long double cos_i, long double eta);
/// 2 * integral of F(mu, eta) mu dmu over [0, 1]
double diffuse_fresnel(double eta);

struct Roughness {
  bool ggx;
  double alpha_u, alpha_v;
};

double normal_density(const Roughness& roughness, Vec m);
double masking(const Roughness& roughness, Vec v);

/// Integral over visible normals m of D_wi(m) g(m), three values of g at once: midpoint rule over slopes in
/// polar form, n x n points. Slopes are (alpha_u r cos phi, alpha_v r sin phi), u = t^2 is the chance of a
/// larger r, du = 2 t dt softens the tail.
Vec mean_over_visible_normals(const Roughness& roughness, Vec wi, int n, const std::function<Vec(Vec)>& g);

struct Albedo {
  double reflected = 0, transmitted = 0;  // single scattering that leaves the surface; no radiance scaling
  double below_horizon = 0;  // chance of a visible normal whose direction (chosen by F) is on the wrong side
};
/// eta 0: a metal with F = 1.
Albedo rough_albedo(const Roughness& roughness, Vec wi, double eta, int n = 500);

}  // namespace kiloband::reference
