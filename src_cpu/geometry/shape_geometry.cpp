#include "src_cpu/geometry/shape_geometry.hpp"

#include <algorithm>
#include <cmath>

#include "shared/warp.h"
#include "src_cpu/geometry/shape_geometry_affine.hpp"

namespace kiloband::cpu {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;
constexpr double kPi = 3.141592653589793238463;

/// The linear part of to_world by columns.
struct Placement {
  glm::dvec3 x, y, z, origin;

  explicit Placement(const KbShape& shape)
      : x(affine_column<double>(shape.to_world, 0)),
        y(affine_column<double>(shape.to_world, 1)),
        z(affine_column<double>(shape.to_world, 2)),
        origin(affine_column<double>(shape.to_world, 3)) {}

  double determinant() const { return glm::dot(x, glm::cross(y, z)); }
  glm::dvec3 to_world(const glm::dvec3& v) const { return v.x * x + v.y * y + v.z * z; }
  InverseMap inverse() const {
    return {{glm::cross(y, z), glm::cross(z, x), glm::cross(x, y)}, determinant()};
  }
  /// Normals go with the inverse transpose; not normalised.
  glm::dvec3 normal_to_world(const glm::dvec3& n) const {
    const glm::dvec3 v = n.x * glm::cross(y, z) + n.y * glm::cross(z, x) + n.z * glm::cross(x, y);
    return determinant() < 0 ? -v : v;
  }
};

/// Both crossings of |o + t d|^2 = radius2, t0 <= t1. The discriminant comes from the point nearest to the
/// centre (b^2 - 4ac loses all digits for far origins), the smaller root from the product of both.
bool solve_quadric(double dd, double od, double oo, double nearest2, double radius2, double& t0, double& t1) {
  const double discriminant = radius2 - nearest2;
  if (!(discriminant >= 0) || !(dd > 0)) return false;
  const double middle = -od / dd;
  const double half = std::sqrt(discriminant / dd);
  const double far_root = middle + std::copysign(half, middle);
  const double near_root = far_root != 0 ? (oo - radius2) / dd / far_root : 0;
  t0 = std::min(far_root, near_root);
  t1 = std::max(far_root, near_root);
  return true;
}

/// Whether a line misses a circle or sphere about the origin for certain, without a division. Most rays that meet the box of a shape's
/// bounds and not the shape end here; those that pass by so closely that rounding might tell otherwise are left to solve_quadric().
/// moment2  the square of o x d
bool misses(double moment2, double dd, double oo, double radius2) {
  constexpr double kShare = 1e-6, kRounding = 4e-24;  // of the radius; of the origin's distance, both squared
  constexpr double kLeast = 1e-280;                   // products of numbers that are not subnormal
  const double bound = dd * (radius2 * (1 + kShare) + kRounding * oo);
  return bound > kLeast && moment2 > bound;
}

bool inside_open(double t, double t_min, double t_max) {
  return t > t_min && t < t_max;
}

bool intersect(const SphereGeometry& sphere, const glm::dvec3& origin, const glm::dvec3& direction,
               double t_min, double t_max, double& t) {
  const glm::dvec3 o = origin - sphere.centre, moment = glm::cross(o, direction);
  const double dd = glm::dot(direction, direction), oo = glm::dot(o, o);
  const double radius2 = sphere.radius * sphere.radius;
  if (misses(glm::dot(moment, moment), dd, oo, radius2)) return false;
  const double od = glm::dot(o, direction);
  const glm::dvec3 nearest = o - (od / dd) * direction;
  double t0, t1;
  if (!solve_quadric(dd, od, oo, glm::dot(nearest, nearest), radius2, t0, t1)) return false;
  const double hit = inside_open(t0, t_min, t_max) ? t0 : t1;
  if (!inside_open(hit, t_min, t_max)) return false;
  t = hit;
  return true;
}

bool intersect(const DiskForm& disk, const glm::dvec3& origin, const glm::dvec3& direction, double t_min,
               double t_max, double& t) {
  const glm::dvec3 o = origin - disk.centre, &n = disk.normal;
  const double hit = -glm::dot(n, o) / glm::dot(n, direction);  // parallel: infinite or NaN, a miss
  if (!inside_open(hit, t_min, t_max) || std::isinf(hit)) return false;
  // p lies in the plane spanned by x and y: its coordinates there are ratios of areas.
  const glm::dvec3 p = o + hit * direction;
  const double nn = glm::dot(n, n);
  const double a = glm::dot(glm::cross(p, disk.y), n) / nn, b = glm::dot(glm::cross(disk.x, p), n) / nn;
  if (!(a * a + b * b <= 1)) return false;
  t = hit;
  return true;
}

bool intersect(const CylinderForm& cylinder, const glm::dvec3& origin, const glm::dvec3& direction,
               double t_min, double t_max, double& t) {
  const InverseMap& inverse = cylinder.inverse;
  const glm::dvec3 scaled_o = inverse.times_determinant(origin - cylinder.origin);
  const glm::dvec3 scaled_d = inverse.times_determinant(direction);
  const double moment = scaled_o.x * scaled_d.y - scaled_o.y * scaled_d.x;
  if (misses(moment * moment, scaled_d.x * scaled_d.x + scaled_d.y * scaled_d.y,
             scaled_o.x * scaled_o.x + scaled_o.y * scaled_o.y, inverse.determinant * inverse.determinant))
    return false;
  const glm::dvec3 o = scaled_o / inverse.determinant, d = scaled_d / inverse.determinant;
  const glm::dvec2 o2(o.x, o.y), d2(d.x, d.y);
  const double dd = glm::dot(d2, d2), od = glm::dot(o2, d2);
  const glm::dvec2 nearest = o2 - (od / dd) * d2;
  double roots[2];
  if (!solve_quadric(dd, od, glm::dot(o2, o2), glm::dot(nearest, nearest), 1, roots[0], roots[1]))
    return false;
  for (const double hit : roots) {
    const double z = o.z + hit * d.z;
    if (inside_open(hit, t_min, t_max) && z >= 0 && z <= 1) {
      t = hit;
      return true;
    }
  }
  return false;
}

/// Of points near shapes of size 1: squares stay in range.
double from_axis(const glm::dvec3& p) {
  return std::sqrt(p.x * p.x + p.y * p.y);
}

/// The nearest point of the canonical shape, sideways: radially for sphere and cylinder,
/// vertically for the disk.
glm::dvec3 project_to_canonical(uint32_t type, const glm::dvec3& p) {
  if (type == KB_SHAPE_DISK) return {p.x, p.y, 0};
  if (type == KB_SHAPE_SPHERE) {
    const double length = glm::length(p);
    return length > 0 ? p / length : glm::dvec3(0, 0, 1);
  }
  const double radius = from_axis(p);
  if (!(radius > 0)) return {1, 0, std::clamp(p.z, 0.0, 1.0)};
  return {p.x / radius, p.y / radius, std::clamp(p.z, 0.0, 1.0)};
}

glm::dvec3 canonical_normal(uint32_t type, const glm::dvec3& p) {
  if (type == KB_SHAPE_DISK) return {0, 0, 1};
  return type == KB_SHAPE_SPHERE ? p : glm::dvec3(p.x, p.y, 0);
}

/// Direction of dp/du; +X or +Y where it vanishes (poles, the disk's centre).
glm::dvec3 canonical_tangent(uint32_t type, const glm::dvec3& p) {
  const double radius = from_axis(p);
  if (type == KB_SHAPE_DISK)
    return radius > 0 ? glm::dvec3(p.x / radius, p.y / radius, 0) : glm::dvec3(1, 0, 0);
  return radius > 0 ? glm::dvec3(-p.y / radius, p.x / radius, 0) : glm::dvec3(0, 1, 0);
}

glm::vec3 canonical_area_point(uint32_t type, glm::vec2 u) {
  if (type == KB_SHAPE_SPHERE) {
    const KbFloat3 w = kb_sphere_uniform(u.x, u.y);
    return {w.x, w.y, w.z};
  }
  if (type == KB_SHAPE_DISK) {
    const KbFloat2 p = kb_disk_concentric(u.x, u.y);
    return {p.x, p.y, 0};
  }
  const float phi = 2 * KB_PI * u.x;
  return {std::cos(phi), std::sin(phi), u.y};
}

AnalyticTangents canonical_tangents(uint32_t type, glm::vec2 uv) {
  constexpr float kTurn = 2 * KB_PI;
  const float phi = kTurn * (type == KB_SHAPE_DISK ? uv.y : uv.x);
  const glm::vec3 outwards(std::cos(phi), std::sin(phi), 0), around(-outwards.y, outwards.x, 0);
  if (type == KB_SHAPE_DISK) return {outwards, kTurn * uv.x * around};
  if (type == KB_SHAPE_CYLINDER) return {kTurn * around, {0, 0, 1}};
  const float sine = std::sin(KB_PI * uv.y), cosine = std::cos(KB_PI * uv.y);
  return {kTurn * sine * around, KB_PI * glm::vec3(cosine * outwards.x, cosine * outwards.y, -sine)};
}

}  // namespace

AnalyticTangents analytic_tangents(const KbShape& shape, glm::vec2 uv) {
  const AnalyticTangents own = canonical_tangents(shape.type, uv);
  return {transform_vector(shape.to_world, own.du), transform_vector(shape.to_world, own.dv)};
}

SphereGeometry sphere_geometry(const KbShape& shape) {
  return {affine_column<double>(shape.to_world, 3), glm::length(affine_column<double>(shape.to_world, 0))};
}

ShapeForm shape_form(const KbShape& shape) {
  if (shape.type == KB_SHAPE_SPHERE) return sphere_geometry(shape);
  const Placement placement(shape);
  if (shape.type == KB_SHAPE_DISK)
    return DiskForm{placement.origin, placement.x, placement.y, glm::cross(placement.x, placement.y)};
  return CylinderForm{placement.origin, placement.inverse()};
}

bool intersect_form(const ShapeForm& form, const glm::dvec3& origin, const glm::dvec3& direction,
                    double t_min, double t_max, double& t) {
  if (const auto* sphere = std::get_if<SphereGeometry>(&form))
    return intersect(*sphere, origin, direction, t_min, t_max, t);
  if (const auto* cylinder = std::get_if<CylinderForm>(&form))
    return intersect(*cylinder, origin, direction, t_min, t_max, t);
  return intersect(*std::get_if<DiskForm>(&form), origin, direction, t_min, t_max, t);
}

bool intersect_analytic(const KbShape& shape, const glm::dvec3& origin, const glm::dvec3& direction,
                        double t_min, double t_max, double& t) {
  return shape.type != KB_SHAPE_MESH && intersect_form(shape_form(shape), origin, direction, t_min, t_max, t);
}

glm::vec2 analytic_uv(uint32_t shape_type, const glm::dvec3& local) {
  const double turn = std::atan2(local.y, local.x) / kTwoPi;
  const float wrapped = static_cast<float>(turn < 0 ? turn + 1 : turn);
  const float phi = wrapped < 1 ? wrapped : 0;
  const double radius = from_axis(local);
  if (shape_type == KB_SHAPE_SPHERE) return {phi, static_cast<float>(std::atan2(radius, local.z) / kPi)};
  if (shape_type == KB_SHAPE_DISK) return {static_cast<float>(radius), phi};
  return {phi, static_cast<float>(local.z)};
}

SurfacePoint analytic_surface(const KbShape& shape, const glm::dvec3& hit_point) {
  const Placement placement(shape);
  const glm::dvec3 local =
      project_to_canonical(shape.type, placement.inverse()(hit_point - placement.origin));
  SurfacePoint point;
  point.position = glm::vec3(placement.origin + placement.to_world(local));
  point.normal = glm::vec3(glm::normalize(placement.normal_to_world(canonical_normal(shape.type, local))));
  if (shape.flags & KB_SHAPE_FLIP_NORMALS) point.normal = -point.normal;
  point.tangent = glm::vec3(glm::normalize(placement.to_world(canonical_tangent(shape.type, local))));
  point.uv = analytic_uv(shape.type, local);
  return point;
}

AreaPoint sample_analytic_area(const KbShape& shape, glm::vec2 u) {
  AreaPoint point;
  point.local = canonical_area_point(shape.type, u);
  point.position = transform_point(shape.to_world, point.local);
  const glm::vec3 x = affine_column<float>(shape.to_world, 0), y = affine_column<float>(shape.to_world, 1),
                  z = affine_column<float>(shape.to_world, 2);
  glm::vec3 normal;
  if (shape.type == KB_SHAPE_DISK) {
    normal = glm::cross(x, y);
    if (glm::dot(normal, z) < 0) normal = -normal;
  } else {
    // Sphere and cylinder with equal radii: the linear map of the outward direction stays
    // normal to the surface.
    normal = point.local.x * x + point.local.y * y;
    if (shape.type == KB_SHAPE_SPHERE) normal += point.local.z * z;
  }
  // Scaled before normalising, so that the squares of tiny or huge lengths stay in range.
  const float largest = std::max({std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)});
  normal = glm::normalize(normal / largest);
  point.normal = shape.flags & KB_SHAPE_FLIP_NORMALS ? -normal : normal;
  return point;
}

}  // namespace kiloband::cpu
