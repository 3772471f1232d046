#include "scenes/generator/primitives.hpp"

#include <stdexcept>

namespace kiloband::generator {
namespace {

/// One face of a cube: the axis that it looks along, its sign, and the axes across in right-handed order.
struct Face {
  int w, u, v;
  double sign;
};

double component(Vec3 a, int axis) {
  return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
void set(Vec3& a, int axis, double value) {
  (axis == 0 ? a.x : axis == 1 ? a.y : a.z) = value;
}

/// A line across a face: for each grid line its place in the flat part [-1, 1] and the direction's
/// component [-1, 1].
struct Line {
  double place, direction;
};
std::vector<Line> box_lines(int segments, int divisions) {
  std::vector<Line> lines;
  const auto tangent = [&](int i) {
    const double a = kPi / 4 * i / segments;
    return i == segments ? 1.0 : sine(a) / cosine(a);
  };
  for (int i = segments; i >= 1; --i) lines.push_back({-1, -tangent(i)});
  for (int i = 0; i <= divisions; ++i) lines.push_back({-1 + 2.0 * i / divisions, 0});
  for (int i = 1; i <= segments; ++i) lines.push_back({1, tangent(i)});
  return lines;
}

/// All corners of the profile are convex or nearly so: a fan about their mean caps it.
void cap(Mesh& mesh, const Ring& ring, bool reversed) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  Vec3 mean;
  for (const Vec3& p : ring) mean = mean + p;
  mesh.positions.push_back(mean * (1.0 / static_cast<double>(ring.size())));
  mesh.positions.insert(mesh.positions.end(), ring.begin(), ring.end());
  mesh.uvs.resize(mesh.positions.size());
  const auto n = static_cast<uint32_t>(ring.size());
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t a = first + 1 + i, b = first + 1 + (i + 1) % n;
    if (mesh.positions[a] == mesh.positions[b]) continue;
    mesh.triangles.push_back(reversed ? std::array{first, b, a} : std::array{first, a, b});
  }
}

void add_triangle(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c) {
  const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
  if (p == q || q == r || r == p) return;
  mesh.triangles.push_back({a, b, c});
}

/// Profiles across a curve, in frames that do not turn about it (projected from point to point).
std::vector<Ring> rings_along(const std::vector<Vec3>& curve, Vec3 right, Ends ends,
                              const std::function<std::vector<Vec2>(double t)>& profile) {
  std::vector<Ring> rings;
  const std::size_t n = curve.size();
  for (std::size_t i = 0; i < n; ++i) {
    const bool wrap = ends == Ends::kJoined;
    const Vec3 before = curve[i > 0  ? i - 1
                              : wrap ? n - 1
                                     : 0],
               after = curve[i + 1 < n ? i + 1
                             : wrap    ? 0
                                       : n - 1];
    const Vec3 along = normalize(after - before);
    right = normalize(right - along * dot(right, along));
    const Vec3 up = cross(along, right);
    Ring ring;
    for (const Vec2& p : profile(static_cast<double>(i) / static_cast<double>(n - 1))) {
      ring.push_back(curve[i] + right * p.x + up * p.y);
    }
    rings.push_back(ring);
  }
  return rings;
}

}  // namespace

Mesh loft_raw(const std::vector<Ring>& rings, const LoftOptions& options) {
  Mesh mesh;
  const std::size_t n = rings.at(0).size(), columns = n + (options.ring_closed ? 1 : 0);
  const bool joined = options.ends == Ends::kJoined;
  const std::size_t rows = rings.size() + (joined ? 1 : 0);
  for (std::size_t r = 0; r < rows; ++r) {
    const Ring& ring = rings[r % rings.size()];
    if (ring.size() != n) throw std::logic_error("loft: rings of different lengths");
    for (std::size_t c = 0; c < columns; ++c) {
      mesh.positions.push_back(ring[c % n]);
      mesh.uvs.push_back({static_cast<double>(c) / static_cast<double>(columns - 1),
                          static_cast<double>(r) / static_cast<double>(rows - 1)});
    }
  }
  for (uint32_t r = 0; r + 1 < rows; ++r) {
    for (uint32_t c = 0; c + 1 < columns; ++c) {
      const auto a = static_cast<uint32_t>(r * columns + c), b = static_cast<uint32_t>(a + columns);
      add_triangle(mesh, a, a + 1, b + 1);
      add_triangle(mesh, a, b + 1, b);
    }
  }
  if (options.ends == Ends::kCapped) {
    cap(mesh, rings.front(), true);
    cap(mesh, rings.back(), false);
  }
  const bool closed = options.ring_closed && options.ends != Ends::kOpen;
  if (closed && signed_volume6(mesh) < 0) flip(mesh);
  return mesh;
}

Mesh loft(const std::vector<Ring>& rings, const LoftOptions& options) {
  return with_smooth_normals(loft_raw(rings, options), options.crease_degrees);
}

Mesh grid(int nu, int nv, const std::function<Vec3(double, double)>& f, double crease_degrees) {
  std::vector<Ring> rings;
  for (int j = 0; j <= nv; ++j) {
    Ring ring;
    for (int i = 0; i <= nu; ++i) ring.push_back(f(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
    rings.push_back(ring);
  }
  return loft(rings, {false, Ends::kOpen, crease_degrees});
}

Mesh picture(Vec3 top_left, Vec3 right, Vec3 down) {
  Mesh mesh = grid(1, 1, [&](double u, double v) { return top_left + right * u + down * v; });
  flip(mesh);
  return mesh;
}

Mesh lathe(const std::vector<Vec2>& profile, int segments, bool joined, double crease_degrees) {
  std::vector<Ring> rings;
  for (const Vec2& p : profile) {
    Ring ring;
    for (int i = 0; i < segments; ++i) {
      const double a = 2 * kPi * i / segments;
      ring.push_back(p.x == 0 ? Vec3{0, p.y, 0} : Vec3{p.x * cosine(a), p.y, p.x * sine(a)});
    }
    rings.push_back(ring);
  }
  Mesh mesh = loft_raw(rings, {true, joined ? Ends::kJoined : Ends::kOpen, crease_degrees});
  const bool on_axis = profile.front().x == 0 && profile.back().x == 0;
  if (on_axis && signed_volume6(mesh) < 0) flip(mesh);
  return with_smooth_normals(mesh, crease_degrees);
}

std::vector<Vec3> smooth_curve(const std::vector<Vec3>& points, int steps) {
  std::vector<Vec3> curve;
  const auto n = static_cast<int>(points.size());
  const auto at = [&](int i) { return points[static_cast<std::size_t>(i < 0 ? 0 : i >= n ? n - 1 : i)]; };
  for (int i = 0; i + 1 < n; ++i) {
    const Vec3 a = at(i), b = at(i + 1), da = (at(i + 1) - at(i - 1)) * 0.5, db = (at(i + 2) - at(i)) * 0.5;
    for (int s = 0; s < steps; ++s) {
      const double t = static_cast<double>(s) / steps, t2 = t * t, t3 = t2 * t;
      curve.push_back(a * (2 * t3 - 3 * t2 + 1) + da * (t3 - 2 * t2 + t) + b * (3 * t2 - 2 * t3) +
                      db * (t3 - t2));
    }
  }
  curve.push_back(points.back());
  return curve;
}

Mesh sweep(const std::vector<Vec3>& curve, const std::vector<Vec2>& profile, Vec3 right, Ends ends,
           double crease_degrees) {
  return loft(rings_along(curve, right, ends, [&](double) { return profile; }), {true, ends, crease_degrees});
}

Mesh tube(const std::vector<Vec3>& curve, const std::function<double(double)>& radius, int segments,
          Ends ends) {
  const Vec3 along = normalize(curve[1] - curve[0]);
  const Vec3 right = std::fabs(along.y) < 0.9 ? cross(along, {0, 1, 0}) : cross(along, {1, 0, 0});
  const auto circle = [&](double t) {
    const double r = radius(t);
    std::vector<Vec2> points;
    for (int k = 0; k < segments; ++k) {
      const double a = 2 * kPi * k / segments;
      points.push_back({r * cosine(a), r * sine(a)});
    }
    return points;
  };
  return loft(rings_along(curve, right, ends, circle), {true, ends, 50});
}

Mesh rounded_box_raw(Vec3 size, double radius, int segments, int divisions) {
  const Vec3 inner{size.x / 2 - radius, size.y / 2 - radius, size.z / 2 - radius};
  const std::vector<Line> lines = box_lines(segments, divisions);
  const auto n = static_cast<uint32_t>(lines.size());
  Mesh mesh;
  for (const Face& f : {Face{0, 1, 2, 1}, Face{0, 2, 1, -1}, Face{1, 2, 0, 1}, Face{1, 0, 2, -1},
                        Face{2, 0, 1, 1}, Face{2, 1, 0, -1}}) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const Line& b : lines) {
      for (const Line& a : lines) {
        Vec3 place, direction;
        set(place, f.w, f.sign * component(inner, f.w));
        set(place, f.u, a.place * component(inner, f.u));
        set(place, f.v, b.place * component(inner, f.v));
        set(direction, f.w, f.sign);
        set(direction, f.u, a.direction);
        set(direction, f.v, b.direction);
        mesh.positions.push_back(place + normalize(direction) * radius);
      }
    }
    for (uint32_t j = 0; j + 1 < n; ++j) {
      for (uint32_t i = 0; i + 1 < n; ++i) {
        const uint32_t a = first + j * n + i;
        add_triangle(mesh, a, a + 1, a + n + 1);
        add_triangle(mesh, a, a + n + 1, a + n);
      }
    }
  }
  return mesh;
}

Mesh rounded_box(Vec3 size, double radius, int segments, int divisions) {
  return with_smooth_normals(rounded_box_raw(size, radius, segments, divisions), 60);
}

Mesh rounded_cylinder(double radius, double height, double edge, int segments, int edge_segments) {
  std::vector<Vec2> profile{{0, 0}};
  for (int i = 0; i <= edge_segments; ++i) {
    const double a = kPi / 2 * i / edge_segments;
    profile.push_back({radius - edge + edge * sine(a), edge - edge * cosine(a)});
  }
  for (int i = 0; i <= edge_segments; ++i) {
    const double a = kPi / 2 * i / edge_segments;
    profile.push_back({radius - edge + edge * cosine(a), height - edge + edge * sine(a)});
  }
  profile.push_back({0, height});
  return lathe(profile, segments, false, 60);
}

Mesh ball(Vec3 centre, double radius, int segments) {
  std::vector<Vec2> profile{{0, -radius}};
  for (int i = 1; i < segments; ++i) {
    const double a = -kPi / 2 + kPi * i / segments;
    profile.push_back({radius * cosine(a), radius * sine(a)});
  }
  profile.push_back({0, radius});
  return transformed(lathe(profile, 2 * segments, false, 180), translate(centre));
}

}  // namespace kiloband::generator
