#include "scene/mesh/polygon.hpp"

#include <cmath>
#include <numeric>

#include "scene/mesh/finish.hpp"

namespace kiloband {
namespace {

using Flat = std::array<double, 2>;

constexpr uint64_t kMaxEarTests = 200'000'000;  // of all faces of a file: a second

/// Twice the area that the face encloses, times its mean normal (Newell): the sum over the fan, whatever its corners.
glm::dvec3 double_area(std::span<const Vec3f> points) {
  glm::dvec3 sum(0);
  for (size_t i = 2; i < points.size(); ++i) sum += double_area_of(points[0], points[i - 1], points[i]);
  return sum;
}

/// Whether a triangle of the fan lies the other way round, by more than rounding makes of corners in a line.
bool fan_folds(std::span<const Vec3f> points, const glm::dvec3& normal) {
  constexpr double kShare = 1e-6;  // of the face's area
  const double least = -kShare * dot(normal, normal);
  for (size_t i = 2; i < points.size(); ++i)
    if (dot(double_area_of(points[0], points[i - 1], points[i]), normal) < least) return true;
  return false;
}

/// The face in the plane of coordinates that shows most of it, counter-clockwise.
void flatten(std::span<const Vec3f> points, const glm::dvec3& normal, std::vector<Flat>& flat) {
  int drop = 0;
  for (const int axis : {1, 2})
    if (std::abs(normal[axis]) > std::abs(normal[drop])) drop = axis;
  const auto u = static_cast<size_t>((drop + 1) % 3), v = static_cast<size_t>((drop + 2) % 3);
  flat.clear();
  for (const Vec3f& p : points) flat.push_back(normal[drop] > 0 ? Flat{p[u], p[v]} : Flat{p[v], p[u]});
}

/// Twice the area of a triangle, positive where it is counter-clockwise.
double turn(const Flat& a, const Flat& b, const Flat& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

}  // namespace

/// No other corner in the triangle or on its edges; corners that coincide with its own do not count.
bool PolygonCutter::is_ear(size_t at) {
  const size_t count = left_.size();
  const uint32_t before = left_[(at + count - 1) % count], behind = left_[(at + 1) % count];
  const Flat &a = flat_[before], &b = flat_[left_[at]], &c = flat_[behind];
  if (!(turn(a, b, c) > 0)) return false;
  for (const uint32_t other : left_) {
    const Flat& p = flat_[other];
    ++tests_;
    if (p == a || p == b || p == c) continue;
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

/// Source: Meisters, Polygons have ears, Am. Math. Monthly 82(6), 1975. Where no true ear is left, what remains may be
/// corners in a line: a corner that turns nowhere is cut off as a triangle without an area.
bool PolygonCutter::cut_ears() {
  triangles_.clear();
  left_.resize(flat_.size());
  std::iota(left_.begin(), left_.end(), 0u);
  size_t at = 1, failed = 0;
  while (left_.size() > 3) {
    const size_t count = left_.size();
    at %= count;
    const uint32_t before = left_[(at + count - 1) % count], behind = left_[(at + 1) % count];
    const bool is_flat = failed >= count && turn(flat_[before], flat_[left_[at]], flat_[behind]) == 0;
    if (!is_flat && !is_ear(at)) {
      if (++failed > 2 * count || tests_ > kMaxEarTests) return false;
      ++at;
      continue;
    }
    triangles_.push_back({before, left_[at], behind});
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
    failed = 0;
  }
  triangles_.push_back({left_[0], left_[1], left_[2]});
  return turn(flat_[left_[0]], flat_[left_[1]], flat_[left_[2]]) >= 0;
}

const std::vector<std::array<uint32_t, 3>>& PolygonCutter::cut(std::span<const Vec3f> points) {
  const glm::dvec3 normal = points.size() > 3 ? double_area(points) : glm::dvec3(0);
  if (points.size() > 3 && fan_folds(points, normal)) {
    flatten(points, normal, flat_);
    if (cut_ears()) return triangles_;
    ++(tests_ > kMaxEarTests ? abandoned_ : crossed_);
  }
  triangles_.clear();
  for (uint32_t i = 2; i < points.size(); ++i) triangles_.push_back({0, i - 1, i});
  return triangles_;
}

void PolygonCutter::report(const MeshFile& file, const DiagnosticSink& sink) const {
  const auto count = [&](size_t faces, const char* one, const char* several, const char* what) {
    if (faces > 0) warn(sink, {file.name}, std::to_string(faces) + (faces == 1 ? one : several) + what);
  };
  count(crossed_, " face is", " faces are", " no simple polygon: cut into a fan, whose triangles overlap");
  count(
      abandoned_, " concave face is", " concave faces are",
      " cut into a fan, whose triangles overlap: the file has too many corners of such faces to cut them by ears");
}

}  // namespace kiloband
