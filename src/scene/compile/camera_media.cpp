#include "scene/compile/camera_media.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "scene/compile/record_vectors.hpp"

namespace kiloband {
namespace {

/// Where a ray crosses a surface, and whether it comes out at its front.
struct Crossing {
  double t;
  bool leaves;
};

struct Ray {
  glm::dvec3 origin, direction;
};

/// A direction that no edge of a scene made by hand is likely to meet.
const glm::dvec3 kDirection = glm::normalize(glm::dvec3(0.60311, 0.28393, 0.74549));

/// source  Moeller, Trumbore: Fast, Minimum Storage Ray/Triangle Intersection (1997)
void cross_triangle(const Ray& ray, const glm::dvec3& p0, const glm::dvec3& e1, const glm::dvec3& e2,
                    std::vector<Crossing>& out) {
  const glm::dvec3 p = glm::cross(ray.direction, e2);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0) return;
  const glm::dvec3 s = ray.origin - p0;
  const double u = glm::dot(s, p) / determinant;
  const glm::dvec3 q = glm::cross(s, e1);
  const double v = glm::dot(ray.direction, q) / determinant;
  const double t = glm::dot(e2, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1 || t <= 0) return;
  out.push_back({t, determinant < 0});  // the normal e1 x e2 points along the ray
}

glm::dvec3 instanced_point(const KbShape& shape, const glm::dvec3& p) {
  const float* m = shape.to_world;
  glm::dvec3 world;
  for (int row = 0; row < 3; ++row)
    world[row] = m[4 * row] * p.x + m[4 * row + 1] * p.y + m[4 * row + 2] * p.z + m[4 * row + 3];
  return world;
}

void cross_mesh(const FlatScene& scene, const KbShape& shape, const Ray& ray, std::vector<Crossing>& out) {
  const auto corner = [&](uint32_t index) {
    const glm::dvec3 p = to_glm(scene.positions[index]);
    return shape.flags & KB_SHAPE_INSTANCED ? instanced_point(shape, p) : p;
  };
  for (uint32_t i = 0; i < shape.triangle_count; ++i) {
    const uint32_t* index = &scene.triangles[3 * (std::size_t{shape.first_triangle} + i)];
    const glm::dvec3 p0 = corner(index[0]);
    cross_triangle(ray, p0, corner(index[1]) - p0, corner(index[2]) - p0, out);
  }
}

/// The inverse of the float transform, in double.
Ray to_object(const KbShape& shape, const Ray& ray) {
  const float* m = shape.to_world;
  const glm::dmat3 linear(glm::dvec3(m[0], m[4], m[8]), glm::dvec3(m[1], m[5], m[9]),
                          glm::dvec3(m[2], m[6], m[10]));
  const glm::dmat3 inverse = glm::inverse(linear);
  return {inverse * (ray.origin - glm::dvec3(m[3], m[7], m[11])), inverse * ray.direction};
}

/// Both roots of a t^2 + 2 b t + c = 0; the first enters, the second leaves.
void cross_quadric(double a, double b, double c, const Ray& ray, double low_z, double high_z,
                   std::vector<Crossing>& out) {
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0) || !(a > 0)) return;
  for (const bool leaves : {false, true}) {
    const double t = (-b + (leaves ? 1 : -1) * std::sqrt(discriminant)) / a;
    const double z = ray.origin.z + t * ray.direction.z;
    if (t > 0 && z >= low_z && z <= high_z) out.push_back({t, leaves});
  }
}

void cross_analytic(const KbShape& shape, const Ray& world, std::vector<Crossing>& out) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Ray ray = to_object(shape, world);
  const glm::dvec3 o = ray.origin, d = ray.direction;
  if (shape.type == KB_SHAPE_SPHERE) {
    cross_quadric(glm::dot(d, d), glm::dot(o, d), glm::dot(o, o) - 1, ray, -kInfinity, kInfinity, out);
  } else if (shape.type == KB_SHAPE_CYLINDER) {
    cross_quadric(d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, o.x * o.x + o.y * o.y - 1, ray, 0, 1, out);
  } else {
    const double t = -o.z / d.z;
    const glm::dvec3 p = o + t * d;
    if (t > 0 && p.x * p.x + p.y * p.y <= 1) out.push_back({t, d.z > 0});
  }
}

std::vector<Crossing> crossings(const FlatScene& scene, const KbShape& shape, const Ray& ray) {
  std::vector<Crossing> out;
  if (shape.type == KB_SHAPE_MESH)
    cross_mesh(scene, shape, ray, out);
  else
    cross_analytic(shape, ray, out);
  if (kb_winding_is_turned(shape.flags))
    for (Crossing& crossing : out) crossing.leaves = !crossing.leaves;
  return out;
}

/// How often the ray has left a medium more than entered it, and where it does so first.
struct Winding {
  int turns = 0;
  double exit = std::numeric_limits<double>::infinity();
};

/// Points of the near plane and the lens through which camera rays may begin, in the camera's coordinates.
std::vector<glm::dvec3> first_points(const Sensor& sensor) {
  const double aspect = static_cast<double>(sensor.film.height) / sensor.film.width;
  double reach = 1, lens = 0;
  if (const auto* perspective = std::get_if<PerspectiveSensor>(&sensor.model))
    reach = sensor.near_clip * std::tan(0.5 * perspective->fov_x);
  if (const auto* thin = std::get_if<ThinLensSensor>(&sensor.model)) {
    reach = sensor.near_clip * std::tan(0.5 * thin->fov_x);
    lens = thin->aperture_radius;
  }
  const bool parallel = std::holds_alternative<OrthographicSensor>(sensor.model);  // has no principal point
  const double middle_x = parallel ? 0 : -2 * sensor.principal_point_x * reach;
  const double middle_y = parallel ? 0 : -2 * sensor.principal_point_y * reach * aspect;
  std::vector<glm::dvec3> points = {{middle_x, middle_y, sensor.near_clip}};
  for (const double x : {-1.0, 1.0})
    for (const double y : {-aspect, aspect})
      points.emplace_back(middle_x + x * (reach + lens), middle_y + y * reach + (y < 0 ? -lens : lens),
                          sensor.near_clip);
  return points;
}

}  // namespace

std::array<uint16_t, KB_MEDIUM_DEPTH> media_at(const FlatScene& scene, const glm::dvec3& point,
                                               const SourcePosition& position) {
  std::map<uint32_t, Winding> windings;
  for (std::size_t s = 0; s < scene.shapes.size(); ++s) {
    if (scene.interiors[s] == KB_NONE) continue;
    Winding& winding = windings[scene.interiors[s]];
    for (const Crossing& crossing : crossings(scene, scene.shapes[s], {point, kDirection})) {
      winding.turns += crossing.leaves ? 1 : -1;
      if (crossing.leaves) winding.exit = std::min(winding.exit, crossing.t);
    }
  }
  std::vector<std::pair<double, uint32_t>> inside;
  for (const auto& [medium, winding] : windings)
    if (winding.turns > 0) inside.emplace_back(-winding.exit, medium);
  if (inside.size() > KB_MEDIUM_DEPTH)
    throw InputError(position, fmt::format("sensor: it stands inside {} media: at most {}", inside.size(),
                                           KB_MEDIUM_DEPTH));
  std::ranges::sort(inside);  // what is left last was entered first
  std::array<uint16_t, KB_MEDIUM_DEPTH> stack{};
  for (std::size_t i = 0; i < inside.size(); ++i) stack[i] = static_cast<uint16_t>(inside[i].second + 1);
  return stack;
}

std::array<uint16_t, KB_MEDIUM_DEPTH> media_at_camera(const FlatScene& scene, const Sensor& sensor) {
  const std::vector<glm::dvec3> points = first_points(sensor);
  const auto at = [&](const glm::dvec3& local) {
    return media_at(scene, glm::dvec3(sensor.to_world * glm::dvec4(local, 1)), sensor.position);
  };
  const auto centre = at(points.front());
  for (const glm::dvec3& point : points) {
    const auto here = at(point);
    if (here == centre) continue;
    const auto [a, b] = std::ranges::mismatch(here, centre);
    const uint16_t medium = *a != 0 ? *a : *b;
    throw InputError(
        sensor.position,
        fmt::format("sensor: its near plane is partly inside medium '{}'; move it or change near_clip",
                    scene.medium_names[medium - 1]));
  }
  return centre;
}

}  // namespace kiloband
