#include "src_cpu/light/area.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/estimator.h"
#include "src_cpu/geometry/ray_offset.hpp"
#include "src_cpu/geometry/shape_geometry.hpp"
#include "src_cpu/lanes/one_lane_glm.hpp"
// After the lanes that it is to be compiled for.
#include "src_cpu/light/area-inl.hpp"

namespace kiloband::cpu {
namespace {

float area_to_solid_angle(glm::vec3 to_light, glm::vec3 front_normal, float area) {
  return one_lane::area_to_solid_angle(to_lane(to_light), glm::length(to_light), to_lane(front_normal), area)
      .v;
}

AreaLightSample sample_mesh(const FlatScene& scene, const KbShape& shape, const TriangleChoice& choice,
                            glm::vec3 point, glm::vec2 u, bool need_uv) {
  const one_lane::ShapeHead record = one_lane::shared_shape(shape);
  const one_lane::MeshTriangle chosen =
      one_lane::choose_triangle(scene, record, choice.u, choice.tree, choice.area, {true});
  const one_lane::AreaSample one =
      one_lane::sample_mesh({scene}, record, chosen, to_lane(point), u.x, u.y, need_uv, {true});
  AreaLightSample sample;
  sample.pdf = one.pdf.v;
  sample.factor = one.factor.v;
  sample.position = to_glm(one.position);
  sample.normal = to_glm(one.normal);
  sample.offset = one.offset.v;
  sample.triangle = one.triangle.v;
  sample.barycentric = to_glm(one.barycentric);
  if (!(sample.pdf > 0)) return sample;
  sample.direction = to_glm(one.direction);
  if (need_uv) sample.uv = to_glm(one.uv);
  return sample;
}

AreaLightSample sample_by_area(const KbShape& shape, glm::vec3 point, glm::vec2 u, bool need_uv) {
  const AreaPoint on_light = sample_analytic_area(shape, u);
  AreaLightSample sample;
  sample.position = on_light.position;
  sample.offset = surface_offset(largest_coordinates(shape), on_light.normal);
  const glm::vec3 to_light = sample.position - point;
  const float distance = glm::length(to_light);
  const one_lane::V3 normal = to_lane(on_light.normal);
  sample.normal = to_glm(one_lane::lit_side(shape.flags, to_lane(to_light), distance, normal, normal));
  sample.pdf = area_to_solid_angle(to_light, sample.normal, shape.area);
  if (!(sample.pdf > 0)) return sample;
  sample.direction = to_light * (1 / distance);
  if (need_uv) sample.uv = analytic_uv(shape.type, on_light.local);
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
  const auto density = static_cast<float>(1 / (2 * std::numbers::pi * one_minus_cos));
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
  return (shape.flags & KB_SHAPE_LIT_BOTH_SIDES) ||
         view.outside() != ((shape.flags & KB_SHAPE_FLIP_NORMALS) != 0);
}

AreaLightSample sample_sphere(const KbShape& shape, glm::vec3 point, glm::vec2 u, bool need_uv) {
  const SphereView view(shape, point);
  if (!sphere_front_visible(shape, view)) return {};
  return view.outside() ? sample_sphere_cone(shape, view, point, u, need_uv)
                        : sample_by_area(shape, point, u, need_uv);
}

}  // namespace

float sphere_light_density(const KbShape& shape, glm::vec3 origin, glm::vec3 hit_point) {
  const SphereView view(shape, origin);
  if (!sphere_front_visible(shape, view)) return 0;
  const glm::vec3 to_light = hit_point - origin;
  // In double from the beginning: from afar the rounding of to_light may exceed the sphere.
  const glm::dvec3 way = glm::dvec3(hit_point) - glm::dvec3(origin), outward = way - view.to_centre;
  if (!view.outside()) return area_to_solid_angle(to_light, glm::vec3(-glm::normalize(outward)), shape.area);
  // The far side, seen through an opening of the near side, shows its back.
  return glm::dot(outward, way) <= 0 ? cone_density(view.one_minus_cos()) : 0;
}

AreaLightSample sample_area_light(const FlatScene& scene, const KbShape& shape, const TriangleChoice& choice,
                                  glm::vec3 point, glm::vec2 u, bool need_uv) {
  if (shape.type == KB_SHAPE_MESH) {
    if (shape.first_cdf == KB_NONE) return {};
    return sample_mesh(scene, shape, choice, point, u, need_uv);
  }
  return shape.type == KB_SHAPE_SPHERE ? sample_sphere(shape, point, u, need_uv)
                                       : sample_by_area(shape, point, u, need_uv);
}

}  // namespace kiloband::cpu
