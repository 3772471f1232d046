// Geometry of the analytic shapes: spheres, disks and cylinders as KbShape::to_world places them.
//
// The geometry is what the float matrix to_world says, read exactly into double precision; to_object is not
// used, since its rounding would move small shapes that are far from the origin. Spheres need a similarity
// transform, disks and cylinders may be any invertible affine image; area sampling of a cylinder is uniform
// where its axes are orthogonal and the radius is the same in all directions
// (what p0, p1 and radius can express).
#pragma once

#include <glm/glm.hpp>
#include <variant>

#include "shared/records.h"

namespace kiloband::cpu {

/// A point on a shape. uv and tangent as Mitsuba parameterises the shape: sphere (phi, theta), disk (r, phi),
/// cylinder (phi, z), with phi / 2 pi in [0, 1), theta / pi, r and z in [0, 1].
struct SurfacePoint {
  glm::vec3 position;  // world, m, on the surface to float precision
  glm::vec3 normal;    // unit, geometric: outwards (disk: local +Z); flipped by KB_SHAPE_FLIP_NORMALS
  glm::vec3 tangent;   // unit, along dp/du
  glm::vec2 uv;
};

/// What inverts a linear map: rows of its cofactor matrix over its determinant.
struct InverseMap {
  glm::dvec3 rows[3];
  double determinant;

  glm::dvec3 operator()(const glm::dvec3& v) const { return times_determinant(v) / determinant; }
  glm::dvec3 times_determinant(const glm::dvec3& v) const {
    return glm::dvec3(glm::dot(rows[0], v), glm::dot(rows[1], v), glm::dot(rows[2], v));
  }
};

/// What rays ask of a shape.
struct SphereGeometry {
  glm::dvec3 centre;
  double radius;
};
struct DiskForm {
  glm::dvec3 centre, x, y, normal;  // x and y: from the centre to the rim; normal: their cross product
};
struct CylinderForm {
  glm::dvec3 origin;
  InverseMap inverse;  // to radius and height 1
};
using ShapeForm = std::variant<SphereGeometry, DiskForm, CylinderForm>;
/// shape  no mesh
ShapeForm shape_form(const KbShape& shape);

/// Nearest hit in the open interval (t_min, t_max); `direction` need not be a unit vector. t is untouched on
/// a miss. Roots are computed without cancellation: an origin on the surface finds itself at |t| of rounding
/// size, and the other crossing to full precision. NaN or infinite input is a miss.
bool intersect_form(const ShapeForm& form, const glm::dvec3& origin, const glm::dvec3& direction,
                    double t_min, double t_max, double& t);
/// The same of a shape; a mesh is a miss.
bool intersect_analytic(const KbShape& shape, const glm::dvec3& origin, const glm::dvec3& direction,
                        double t_min, double t_max, double& t);

/// Attributes at a point near the surface (a hit whose distance was rounded):
/// the point is projected onto the surface.
SurfacePoint analytic_surface(const KbShape& shape, const glm::dvec3& hit_point);

/// dp/du and dp/dv there, world.
struct AnalyticTangents {
  glm::vec3 du, dv;
};
AnalyticTangents analytic_tangents(const KbShape& shape, glm::vec2 uv);

/// A uniformly distributed point: density 1 / area. `local` is the point in the shape's own coordinates.
struct AreaPoint {
  glm::vec3 position;  // world, m
  glm::vec3 normal;    // as SurfacePoint::normal
  glm::vec3 local;
};
AreaPoint sample_analytic_area(const KbShape& shape, glm::vec2 u);

/// uv of a point given in the shape's own coordinates.
glm::vec2 analytic_uv(uint32_t shape_type, const glm::dvec3& local);

SphereGeometry sphere_geometry(const KbShape& shape);

}  // namespace kiloband::cpu
