// Vectors and affine maps of the scene generator: double precision, one fixed order of operations.
#pragma once

#include <cmath>

#include "scenes/generator/exact_math.hpp"

namespace kiloband::generator {

struct Vec2 {
  double x = 0, y = 0;
};

struct Vec3 {
  double x = 0, y = 0, z = 0;

  bool operator==(const Vec3&) const = default;
};

inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(Vec3 a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Vec3 operator*(Vec3 a, Vec3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
/// The zero vector stays zero.
inline Vec3 normalize(Vec3 a) {
  const double l = length(a);
  return l > 0 ? a * (1 / l) : a;
}
inline Vec3 mix(Vec3 a, Vec3 b, double t) {
  return a + (b - a) * t;
}

/// x -> axes * x + origin
struct Frame {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

  Vec3 direction(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 point(Vec3 p) const { return direction(p) + origin; }
};

/// First b, then a.
inline Frame operator*(const Frame& a, const Frame& b) {
  return {a.direction(b.x), a.direction(b.y), a.direction(b.z), a.point(b.origin)};
}

inline Frame translate(Vec3 t) {
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, t};
}
inline Frame scale(Vec3 s) {
  return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {}};
}
/// Counter-clockwise, seen against the axis; angles in degrees.
inline Frame rotate_x(double degrees) {
  const double c = cosine(degrees * kPi / 180), s = sine(degrees * kPi / 180);
  return {{1, 0, 0}, {0, c, s}, {0, -s, c}, {}};
}
inline Frame rotate_y(double degrees) {
  const double c = cosine(degrees * kPi / 180), s = sine(degrees * kPi / 180);
  return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}, {}};
}
inline Frame rotate_z(double degrees) {
  const double c = cosine(degrees * kPi / 180), s = sine(degrees * kPi / 180);
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}, {}};
}

}  // namespace kiloband::generator
