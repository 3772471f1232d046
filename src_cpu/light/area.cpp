#include "src_cpu/light/area.hpp"

#include <algorithm>
#include <cmath>

#include "shared/estimator.h"
#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"
#include "src_cpu/geometry/shape_geometry_warp.hpp"

namespace kiloband::cpu {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;

/// Area to solid angle: a point chosen with density 1 / area is seen with density distance^2 / (area cos).
/// to_light  from the shaded point to the light, unnormalised, of length `distance`
/// returns   0 behind the light, where there is no distance, and where the density exceeds the range of float
float area_to_solid_angle(glm::vec3 to_light, float distance, glm::vec3 front_normal, float area) {
  const float facing = -glm::dot(to_light, front_normal);  // distance * cos
  if (!(facing > 0)) return 0;
  const float density = distance * distance * (distance / (facing * area));
  return std::isfinite(density) ? density : 0;
}

float area_to_solid_angle(glm::vec3 to_light, glm::vec3 front_normal, float area) {
  return area_to_solid_angle(to_light, glm::length(to_light), front_normal, area);
}

bool lit_on_both_sides(const KbShape& shape) {
  return shape.flags & KB_SHAPE_LIT_BOTH_SIDES;
}

/// The geometric normal of the side that is seen; 0: it does not emit to there, or is edge-on. Vertex normals
/// may let a triangle shine to the back of its winding: the density goes with the geometric
/// cosine all the same.
glm::vec3 lit_side(const KbShape& shape, glm::vec3 to_light, glm::vec3 geometric_normal,
                   glm::vec3 shading_normal) {
  if (!lit_on_both_sides(shape) && !on_front(shading_normal, -to_light)) return glm::vec3(0);
  const float away = glm::dot(to_light, geometric_normal);
  if (!(std::fabs(away) > KB_EDGE_ON * glm::length(to_light))) return glm::vec3(0);
  return away > 0 ? -geometric_normal : geometric_normal;
}

/// Completes a sample whose position and geometric normal are known.
void finish_by_area(AreaLightSample& sample, const KbShape& shape, glm::vec3 point,
                    glm::vec3 shading_normal) {
  const glm::vec3 to_light = sample.position - point;
  const float distance = glm::length(to_light), area = shape.area;
  sample.normal = lit_side(shape, to_light, sample.normal, shading_normal);
  sample.pdf = area_to_solid_angle(to_light, distance, sample.normal, area);
  if (sample.pdf > 0) sample.direction = to_light * (1 / distance);
}

glm::vec3 vertex(const FlatScene& scene, uint32_t index) {
  const KbFloat3& p = scene.positions[index];
  return {p.x, p.y, p.z};
}

glm::vec2 triangle_uv(const FlatScene& scene, const KbShape& shape, const uint32_t* indices, glm::vec2 b) {
  if (!(shape.flags & KB_SHAPE_HAS_UVS)) return b;  // Mitsuba: barycentric coordinates
  const KbFloat2 &a0 = scene.uvs[indices[0]], &a1 = scene.uvs[indices[1]], &a2 = scene.uvs[indices[2]];
  const float b0 = 1 - b.x - b.y;
  return {b0 * a0.x + b.x * a1.x + b.y * a2.x, b0 * a0.y + b.x * a1.y + b.y * a2.y};
}

/// In double, as flattening has it: slivers lose no digits.
float triangle_area(glm::vec3 p0, glm::vec3 p1, glm::vec3 p2) {
  const glm::dvec3 origin(p0);
  return static_cast<float>(0.5 * glm::length(glm::cross(glm::dvec3(p1) - origin, glm::dvec3(p2) - origin)));
}

/// Triangles are chosen with the steps that lattice_cdf() gave them, which is their part of the area only up
/// to 2^-24. The density is 1 / area of the mesh, as for hits, whose triangle is unknown, so that MIS weights
/// sum to 1; `factor` is that density over the real one, probability of the triangle / its area.
AreaLightSample sample_mesh(const FlatScene& scene, const KbShape& shape, glm::vec3 point, float u_triangle,
                            glm::vec2 u, bool need_uv) {
  const float* const cdf = &scene.area_cdf[shape.first_cdf];
  const uint32_t triangle = find_interval(cdf, shape.triangle_count, u_triangle);
  const uint32_t* indices = &scene.triangles[3 * (static_cast<std::size_t>(shape.first_triangle) + triangle)];
  const glm::vec3 p0 = vertex(scene, indices[0]), p1 = vertex(scene, indices[1]);
  const glm::vec3 p2 = vertex(scene, indices[2]);
  const glm::vec3 e1 = p1 - p0, e2 = p2 - p0;
  const glm::vec2 b = warp_uniform_triangle(u);
  AreaLightSample sample;
  sample.position = p0 + b.x * e1 + b.y * e2;
  sample.normal = triangle_normal(shape, e1, e2);
  sample.offset = surface_offset(largest_coordinates(p0, p1, p2), sample.normal);
  finish_by_area(sample, shape, point, triangle_shading_normal(scene, shape, indices, b, sample.normal));
  sample.triangle = triangle;
  sample.barycentric = b;
  sample.factor = triangle_area(p0, p1, p2) / shape.area / (cdf[triangle + 1] - cdf[triangle]);
  if (need_uv && sample.pdf > 0) sample.uv = triangle_uv(scene, shape, indices, b);
  return sample;
}

AreaLightSample sample_by_area(const KbShape& shape, glm::vec3 point, glm::vec2 u, bool need_uv) {
  const AreaPoint on_light = sample_analytic_area(shape, u);
  AreaLightSample sample;
  sample.position = on_light.position;
  sample.normal = on_light.normal;
  sample.offset = surface_offset(largest_coordinates(shape), sample.normal);
  finish_by_area(sample, shape, point, sample.normal);
  if (need_uv && sample.pdf > 0) sample.uv = analytic_uv(shape.type, on_light.local);
  return sample;
}

// ---- spheres -----------------------------------------------------------------------------------------
// From outside, directions are uniform over the cone that the sphere subtends, of half angle theta_m with
// sin theta_m = r / d. 1 - cos theta_m = sin^2 / (1 + cos) keeps its digits for tiny and far spheres, and
// cos theta_m = sqrt(d^2 - r^2) / d for touching ones.
// All of it in double: radius and distance may differ by 1e8.

/// Where a sphere lies as seen from a point.
struct SphereView {
  glm::dvec3 to_centre;
  double radius, distance2;

  SphereView(const KbShape& shape, glm::vec3 point) {
    const SphereGeometry sphere = sphere_geometry(shape);
    to_centre = sphere.centre - glm::dvec3(point);
    radius = sphere.radius;
    distance2 = glm::dot(to_centre, to_centre);
  }
  bool outside() const { return distance2 > radius * radius; }
  double one_minus_cos() const {
    const double sin2 = radius * radius / distance2;
    return sin2 / (1 + std::sqrt((distance2 - radius * radius) / distance2));
  }
};

float cone_density(double one_minus_cos) {
  const auto density = static_cast<float>(1 / (kTwoPi * one_minus_cos));
  return std::isfinite(density) ? density : 0;
}

/// An orthonormal pair perpendicular to the unit vector n (Duff et al. 2017).
void tangents(const glm::dvec3& n, glm::dvec3& s, glm::dvec3& t) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1 / (sign + n.z), b = n.x * n.y * a;
  s = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  t = {b, sign + n.y * n.y * a, -n.y};
}

AreaLightSample sample_sphere_cone(const KbShape& shape, const SphereView& view, glm::vec3 point, glm::vec2 u,
                                   bool need_uv) {
  const double cone = view.one_minus_cos();
  const double height = u.x * cone;  // 1 - cos theta, uniform in [0, 1 - cos theta_m)
  const double cos_theta = 1 - height, sin_theta = std::sqrt(height * (2 - height));
  const double distance = std::sqrt(view.distance2);
  const glm::dvec3 axis = view.to_centre / distance;
  glm::dvec3 s, t;
  tangents(axis, s, t);
  const float phi = 2 * KB_PI * u.y;
  const glm::dvec3 w = cos_theta * axis + sin_theta * (double(std::cos(phi)) * s + double(std::sin(phi)) * t);
  // Nearer crossing of the sphere; the factors keep the digits near the tangent.
  const double off_axis = distance * sin_theta;
  const double half_chord = std::sqrt(std::max(0.0, (view.radius - off_axis) * (view.radius + off_axis)));
  const glm::dvec3 n = glm::normalize((distance * cos_theta - half_chord) * w - view.to_centre);

  AreaLightSample sample;
  sample.pdf = cone_density(cone);
  sample.direction = glm::vec3(w);
  sample.position = glm::vec3(glm::dvec3(point) + view.to_centre + view.radius * n);
  sample.normal = glm::vec3(n);
  sample.offset = surface_offset(largest_coordinates(shape), sample.normal);
  if (need_uv) sample.uv = analytic_surface(shape, glm::dvec3(sample.position)).uv;
  return sample;
}

/// A sphere's front is seen from outside, or from inside if its normals are flipped.
bool sphere_front_visible(const KbShape& shape, const SphereView& view) {
  return lit_on_both_sides(shape) || view.outside() != ((shape.flags & KB_SHAPE_FLIP_NORMALS) != 0);
}

AreaLightSample sample_sphere(const KbShape& shape, glm::vec3 point, glm::vec2 u, bool need_uv) {
  const SphereView view(shape, point);
  if (!sphere_front_visible(shape, view)) return {};
  return view.outside() ? sample_sphere_cone(shape, view, point, u, need_uv)
                        : sample_by_area(shape, point, u, need_uv);
}

float sphere_density(const KbShape& shape, glm::vec3 origin, glm::vec3 hit_point) {
  const SphereView view(shape, origin);
  if (!sphere_front_visible(shape, view)) return 0;
  const glm::vec3 to_light = hit_point - origin;
  // In double from the beginning: from afar the rounding of to_light may exceed the sphere.
  const glm::dvec3 way = glm::dvec3(hit_point) - glm::dvec3(origin), outward = way - view.to_centre;
  if (!view.outside()) return area_to_solid_angle(to_light, glm::vec3(-glm::normalize(outward)), shape.area);
  // The far side, seen through an opening of the near side, shows its back.
  return glm::dot(outward, way) <= 0 ? cone_density(view.one_minus_cos()) : 0;
}

}  // namespace

AreaLightSample sample_area_light(const FlatScene& scene, const KbShape& shape, glm::vec3 point,
                                  float u_triangle, glm::vec2 u, bool need_uv) {
  if (shape.type == KB_SHAPE_MESH) {
    if (shape.first_cdf == KB_NONE) return {};
    return sample_mesh(scene, shape, point, u_triangle, u, need_uv);
  }
  return shape.type == KB_SHAPE_SPHERE ? sample_sphere(shape, point, u, need_uv)
                                       : sample_by_area(shape, point, u, need_uv);
}

float area_light_density(const KbShape& shape, const SurfaceHit& hit, glm::vec3 origin) {
  if (shape.type == KB_SHAPE_SPHERE) return sphere_density(shape, origin, hit.point);
  if (shape.type == KB_SHAPE_MESH && shape.first_cdf == KB_NONE) return 0;
  const glm::vec3 to_light = hit.point - origin;
  return area_to_solid_angle(to_light, lit_side(shape, to_light, hit.geometric_normal, hit.shading_normal),
                             shape.area);
}

}  // namespace kiloband::cpu
