// A head and shoulders in the classical manner, of blended bodies.
// Metres at life size, face to +z, chin about y = 0.34.
#include "scenes/generator/implicit.hpp"
#include "scenes/generator/primitives.hpp"
#include "scenes/generator/statues/statues.hpp"

namespace kiloband::generator {
namespace {

/// Left and right half are the same.
Vec3 mirrored(Vec3 p) {
  return {std::fabs(p.x), p.y, p.z};
}

double skull(Vec3 p, Vec3 m) {
  double d = ellipsoid_distance(p, {0, 0.470, -0.018}, {0.078, 0.092, 0.098});
  d = blend(d, ellipsoid_distance(p, {0, 0.412, 0.022}, {0.063, 0.098, 0.072}), 0.03);
  d = blend(d, ellipsoid_distance(p, {0, 0.338, 0.062}, {0.030, 0.022, 0.026}), 0.035);
  d = blend(d, sphere_distance(m, {0.040, 0.405, 0.060}, 0.024), 0.03);
  d = blend(d, capsule_distance(m, {0.052, 0.375, 0.0}, {0.026, 0.335, 0.05}, 0.02, 0.018), 0.03);
  d = blend(d, capsule_distance(m, {0.008, 0.449, 0.089}, {0.046, 0.452, 0.070}, 0.011, 0.008), 0.02);
  return blend_difference(d, sphere_distance(m, {0.032, 0.432, 0.106}, 0.021), 0.018);
}

/// Eyeball and lids: a slightly larger ball with a slot.
double eye(Vec3 m) {
  const Vec3 centre{0.031, 0.430, 0.0715};
  const double ball = sphere_distance(m, centre, 0.0150);
  const double slot = ellipsoid_distance(m, centre + Vec3{0, -0.0005, 0.014}, {0.0135, 0.0052, 0.02});
  return blend(ball, blend_difference(sphere_distance(m, centre, 0.0172), slot, 0.003), 0.002);
}

double nose(Vec3 p, Vec3 m) {
  double d = capsule_distance(p, {0, 0.448, 0.090}, {0, 0.402, 0.112}, 0.0075, 0.0105);
  d = blend(d, sphere_distance(p, {0, 0.3985, 0.1135}, 0.0115), 0.01);
  d = blend(d, ellipsoid_distance(m, {0.0125, 0.396, 0.102}, {0.0085, 0.0085, 0.012}), 0.008);
  return blend_difference(d, ellipsoid_distance(m, {0.0068, 0.3885, 0.108}, {0.0038, 0.004, 0.006}), 0.004);
}

double mouth(Vec3 m) {
  double d = capsule_distance(m, {0.004, 0.3705, 0.0945}, {0.023, 0.3645, 0.082}, 0.0058, 0.003);
  d = blend(d, capsule_distance(m, {0, 0.3575, 0.0925}, {0.019, 0.3625, 0.082}, 0.0068, 0.003), 0.003);
  return blend_difference(
      d, capsule_distance(m, {0, 0.3645, 0.1010}, {0.021, 0.3635, 0.0875}, 0.0022, 0.0016), 0.003);
}

double ear(Vec3 m) {
  const Vec3 q{m.x - 0.3 * (m.z + 0.01) * -0.6, m.y, m.z};
  const double shell = ellipsoid_distance(q, {0.079, 0.425, -0.012}, {0.011, 0.033, 0.020});
  return blend_difference(shell, ellipsoid_distance(q, {0.090, 0.430, -0.008}, {0.008, 0.021, 0.011}), 0.006);
}

/// Waves of hair: stripes that follow a warped angle about the crown.
double hair(Vec3 p) {
  const Vec3 d = p - Vec3{0, 0.50, -0.04};
  const double warp = turbulence(p * 14, 100, 2);
  const double around = arctangent(d.x, d.z), down = length({d.x, 0.7 * d.y, d.z});
  const double locks = sine(15 * around + 60 * down + 3.0 * warp),
               fine = sine(47 * around + 150 * down + 7.0 * warp);
  const double parting = smooth_step(0, 0.05, length({d.x, 0, d.z}));  // locks have no angle at the crown
  const double cap = ellipsoid_distance(p, {0, 0.478, -0.026}, {0.087, 0.098, 0.106}) -
                     0.0045 * parting * locks - 0.0012 * parting * fine;
  const double brow = dot(p - Vec3{0, 0.500, 0.078}, {0, -0.50, 0.866}) - 0.004 * sine(260 * p.x);
  const double front = blend_intersection(cap, brow, 0.012);
  const double bun = ellipsoid_distance(p, {0, 0.455, -0.135}, {0.040, 0.036, 0.034}) -
                     0.003 * sine(150 * d.y + 20 * p.x + 3 * warp);
  return blend(front, bun, 0.012);
}

/// A wreath: two rows of leaves that lie against the head and point to its front.
double wreath(Vec3 m) {
  double d = 1;
  for (int i = 0; i < 9; ++i) {
    const double a = 2.75 - 0.29 * i, lift = 0.487 + 0.010 * (i % 2) + 0.020 * smooth_step(2.7, 0.4, a);
    const Vec3 centre{0.092 * sine(a), lift, -0.024 + 0.110 * cosine(a)};
    const Vec3 out{sine(a), 0.15, cosine(a)};
    const Vec3 along = normalize(Vec3{cosine(a), 0.35 * (i % 2 ? 1 : -1), -sine(a)} * -1.0);
    const Vec3 across = cross(along, normalize(out)), q = m - centre;
    const Vec3 local{dot(q, along), dot(q, across), dot(q, normalize(out))};
    d = blend(d, ellipsoid_distance(local, {}, {0.024, 0.0100, 0.0062}), 0.004);
  }
  return d;
}

double neck_and_shoulders(Vec3 p, Vec3 m) {
  double d = capsule_distance(p, {0, 0.37, -0.022}, {0, 0.20, -0.040}, 0.050, 0.060);
  d = blend(d, capsule_distance(m, {0.052, 0.375, -0.018}, {0.014, 0.205, 0.022}, 0.014, 0.011), 0.02);
  d = blend(d, ellipsoid_distance(p, {0, 0.10, -0.03}, {0.165, 0.125, 0.095}), 0.05);
  d = blend(d, capsule_distance(m, {0.03, 0.225, -0.055}, {0.165, 0.165, -0.04}, 0.035, 0.050), 0.06);
  d = blend(d, capsule_distance(m, {0.015, 0.196, 0.020}, {0.135, 0.205, 0.000}, 0.010, 0.012), 0.018);
  d = blend(d, ellipsoid_distance(m, {0.075, 0.11, 0.03}, {0.075, 0.07, 0.045}), 0.04);
  // Cut as busts are: by a vertical oval through the arms and a hollow below.
  return blend_intersection(d, ellipsoid_distance(p, {0, 0.245, -0.02}, {0.195, 0.235, 0.16}), 0.012);
}

double field(Vec3 p) {
  const Vec3 trunk_p = p - Vec3{0, 0.028, 0}, trunk_m = mirrored(trunk_p);
  p.x *= 0.94;  // a broader face
  const Vec3 m = mirrored(p);
  double d = skull(p, m);
  d = blend(d, nose(p, m), 0.012);
  d = blend(d, mouth(m), 0.008);
  d = blend(d, eye(m), 0.004);
  d = blend(d, ear(m), 0.008);
  d = blend(d, neck_and_shoulders(trunk_p, trunk_m), 0.025);
  d = blend(d, hair(p), 0.006);
  return blend(d, wreath(m), 0.004);
}

}  // namespace

Mesh bust() {
  Mesh head = surface_of(field, {{-0.22, -0.03, -0.20}, {0.22, 0.62, 0.15}}, 0.0050, 2.2);
  Mesh result = transformed(head, translate({0, 0.13, 0}));
  const Mesh foot = lathe({{0, 0},
                           {0.105, 0},
                           {0.11, 0.006},
                           {0.11, 0.024},
                           {0.104, 0.030},
                           {0.088, 0.034},
                           {0.084, 0.042},
                           {0.074, 0.050},
                           {0.060, 0.065},
                           {0.054, 0.085},
                           {0.056, 0.105},
                           {0.066, 0.122},
                           {0.080, 0.134},
                           {0.082, 0.142},
                           {0.078, 0.150},
                           {0, 0.160}},
                          96, false, 50);
  Mesh both = foot;
  append(both, Mesh{result.positions, result.normals, {}, result.triangles});
  both = transformed(both, scale({1.35, 1.35, 1.35}));
  project_uvs(both, {0.75, 0.1, 0.35}, {0.1, -0.8, 0.2});
  return both;
}

}  // namespace kiloband::generator
