// Bodies given by a function that is negative inside, and their surface as triangles.
#pragma once

#include <functional>

#include "scenes/generator/mesh.hpp"

namespace kiloband::generator {

/// Distance to the surface or a lower bound of it, metres; negative inside.
using Field = std::function<double(Vec3)>;

struct Bounds {
  Vec3 low, high;  // the surface lies strictly inside
};

/// Triangles of field = 0: marching tetrahedra on cubes of `step`, each cut into six tetrahedra along one
/// diagonal. The surface is closed and manifold by construction; its normals are the field's gradient.
/// steepness  bound of the field's gradient: cubes that are too far from the surface for it are skipped
Mesh surface_of(const Field& field, const Bounds& bounds, double step, double steepness = 1.5);

// ---- bodies ----

double sphere_distance(Vec3 p, Vec3 centre, double radius);
/// Not the distance but scaled to be close to it near the surface.
double ellipsoid_distance(Vec3 p, Vec3 centre, Vec3 radii);
/// Cone with round ends: radius a_radius at a, b_radius at b.
double capsule_distance(Vec3 p, Vec3 a, Vec3 b, double a_radius, double b_radius);

/// Union and intersection with a fillet of about `radius`: the polynomial smooth minimum of Quilez.
double blend(double a, double b, double radius);
double blend_intersection(double a, double b, double radius);
inline double blend_difference(double a, double b, double radius) {
  return blend_intersection(a, -b, radius);
}

/// Gradient noise in [-1, 1] with features of size 1, and the sum of `octaves` of it
/// at doubled frequency and half height.
double noise(Vec3 p, unsigned seed);
double turbulence(Vec3 p, unsigned seed, int octaves);

}  // namespace kiloband::generator
