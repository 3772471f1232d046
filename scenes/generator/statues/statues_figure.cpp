// A standing figure under a veil: a body of blended bodies whose robe and veil fall in folds.
#include "scenes/generator/implicit.hpp"
#include "scenes/generator/primitives.hpp"
#include "scenes/generator/statues/statues.hpp"

namespace kiloband::generator {
namespace {

/// Piecewise smooth interpolation of the robe's half axes over height.
struct Section {
  double y, x, z;
};
constexpr Section kRobe[] = {{-0.1, 0.33, 0.29},   {0.0, 0.32, 0.28},    {0.12, 0.275, 0.245},
                             {0.45, 0.215, 0.19},  {0.80, 0.195, 0.165}, {0.95, 0.19, 0.155},
                             {1.12, 0.150, 0.120}, {1.28, 0.175, 0.130}, {1.38, 0.185, 0.115},
                             {1.46, 0.13, 0.09},   {1.60, 0.05, 0.05}};

Section robe_at(double y) {
  const Section* s = kRobe;
  while (s + 2 < std::end(kRobe) && s[1].y < y) ++s;
  const double t =
      smooth_step(s[0].y, s[1].y, y) * 0.35 + 0.65 * clamp((y - s[0].y) / (s[1].y - s[0].y), 0, 1);
  return {y, mix(s[0].x, s[1].x, t), mix(s[0].z, s[1].z, t)};
}

/// The weight rests on one leg: the axis swings.
Vec3 without_stance(Vec3 p) {
  return {p.x - 0.035 * sine(2.6 * p.y) * smooth_step(0.1, 0.6, p.y), p.y,
          p.z - 0.02 * sine(2.2 * p.y + 0.4)};
}

/// Rounded ridges with sharper valleys between.
double folds(double phase) {
  const double s = sine(phase);
  return std::sqrt(s * s + 0.03) - 0.65;
}

/// Folds hang from the waist: deep and few at the hem, broken up by noise.
double robe(Vec3 p) {
  const Section s = robe_at(p.y);
  const double angle = arctangent(p.x / s.x, p.z / s.z);
  const double warp = turbulence({2.2 * p.x, 1.1 * p.y, 2.2 * p.z}, 200, 2);
  const double knee = exponential(-30 * ((p.x - 0.09) * (p.x - 0.09) + (p.y - 0.55) * (p.y - 0.55)));
  const double depth = mix(0.034, 0.010, smooth_step(0.0, 1.1, p.y)) * (1 - 0.85 * knee * (p.z > 0));
  const double ridge =
      folds(5.5 * angle + 2.4 * warp + 0.6 * p.y) + 0.35 * folds(11 * angle - 3.5 * warp + 1.7);
  const Vec3 q{p.x / s.x, 0, p.z / s.z};
  const double r = length(q);
  const double around = r > 1e-9 ? (r - 1) * r / length({q.x / s.x, 0, q.z / s.z}) : -std::min(s.x, s.z);
  const double thigh = 0.028 * knee * smooth_step(0, 0.1, p.z);
  return std::max(around - depth * ridge - thigh, std::max(-p.y, p.y - 1.56));
}

/// A cloak laid from the left shoulder across to the right hip: its own, slanting folds.
double cloak(Vec3 p) {
  const Section s = robe_at(p.y);
  const double slant = p.y + 0.95 * p.x * (p.z > -0.05 ? 1.0 : 0.3);
  const double warp = turbulence({3 * p.x, 3 * p.y, 3 * p.z}, 210, 2);
  const Vec3 q{p.x / (s.x + 0.028), 0, p.z / (s.z + 0.030)};
  const double r = length(q);
  const double around = r > 1e-9 ? (r - 1) * std::min(s.x, s.z) : -std::min(s.x, s.z);
  const double ridge = folds(30 * slant + 2.5 * warp + 1.2 * p.x);
  const double edge = 0.62 + 0.06 * sine(7 * p.x);
  const double slab = std::max(edge - slant, slant - 1.30);
  return blend_intersection(around - 0.014 * ridge, slab, 0.02);
}

double head(Vec3 p) {
  const Vec3 m{std::fabs(p.x), p.y, p.z};
  double d = ellipsoid_distance(p, {0, 1.64, 0.01}, {0.072, 0.098, 0.088});
  d = blend(d, ellipsoid_distance(p, {0, 1.565, 0.055}, {0.024, 0.02, 0.024}), 0.03);
  d = blend(d, capsule_distance(p, {0, 1.655, 0.09}, {0, 1.615, 0.106}, 0.008, 0.011), 0.015);
  d = blend_difference(d, sphere_distance(m, {0.03, 1.647, 0.112}, 0.02), 0.02);
  d = blend(d, sphere_distance(m, {0.030, 1.645, 0.079}, 0.0145), 0.006);
  d = blend(d, capsule_distance(m, {0, 1.588, 0.088}, {0.02, 1.588, 0.078}, 0.007, 0.004), 0.012);
  return blend(d, capsule_distance(p, {0, 1.60, -0.01}, {0, 1.42, -0.02}, 0.045, 0.06), 0.03);
}

/// From the crown over the shoulders down the back, open at the face.
double veil(Vec3 p) {
  const double over_head = ellipsoid_distance(p, {0, 1.645, -0.012}, {0.092, 0.115, 0.108});
  const double over_back = capsule_distance(p, {0, 1.58, -0.03}, {0, 1.05, -0.07}, 0.085, 0.20);
  const double flat = std::max(over_back, ellipsoid_distance(p, {0, 1.25, -0.06}, {0.235, 0.50, 0.155}));
  const double angle = arctangent(p.x, p.z + 0.02), warp = turbulence(p * 3.5, 220, 2);
  const double depth = 0.013 * smooth_step(1.75, 1.45, p.y) + 0.002;
  double d = blend(over_head, flat, 0.05) - depth * folds(8 * angle + 2.2 * warp);
  const double opening =
      ellipsoid_distance(p, {0, 1.55, 0.16}, {0.056 + 0.02 * smooth_step(1.6, 1.3, p.y), 0.175, 0.17});
  d = blend_difference(d, opening, 0.02);
  const double front = p.z - 0.02 - 0.25 * (1.5 - p.y);
  return blend_intersection(d, std::max(front, 0.92 - p.y - 0.3 * p.z), 0.03);
}

double arms(Vec3 p) {
  // Left arm hangs with the elbow bent, right hand lies on the breast.
  double d = capsule_distance(p, {0.175, 1.38, -0.01}, {0.255, 1.10, -0.02}, 0.058, 0.050);
  d = blend(d, capsule_distance(p, {0.255, 1.10, -0.02}, {0.205, 0.98, 0.17}, 0.050, 0.036), 0.03);
  d = blend(d, ellipsoid_distance(p, {0.190, 0.96, 0.225}, {0.030, 0.022, 0.055}), 0.02);
  double right = capsule_distance(p, {-0.175, 1.38, -0.01}, {-0.255, 1.13, 0.03}, 0.058, 0.052);
  right = blend(right, capsule_distance(p, {-0.255, 1.13, 0.03}, {-0.075, 1.26, 0.155}, 0.050, 0.034), 0.03);
  right = blend(right, ellipsoid_distance(p, {-0.030, 1.285, 0.155}, {0.050, 0.024, 0.022}), 0.02);
  const double sleeves =
      0.007 * folds(34 * p.y + 22 * p.x + 3 * noise(p * 7, 230)) * smooth_step(0.20, 0.12, p.z);
  return std::min(d, right) - sleeves;
}

double field(Vec3 p) {
  const Vec3 q = without_stance(p);
  double d = robe(q);
  d = blend(d, cloak(q), 0.015);
  d = blend(d, arms(q), 0.03);
  d = blend(d, head(q), 0.02);
  d = blend(d, veil(q), 0.012);
  const double feet =
      ellipsoid_distance({std::fabs(p.x - 0.02), p.y, p.z}, {0.09, 0.02, 0.25}, {0.045, 0.045, 0.10});
  d = blend(d, std::max(feet, -p.y), 0.02);
  // A low round plinth that belongs to the cast.
  const double radius = length({p.x, 0, p.z});
  return blend(d, std::max(radius - 0.40, std::max(p.y - 0.015, -0.045 - p.y)), 0.01);
}

}  // namespace

Mesh veiled_figure() {
  return transformed(surface_of(field, {{-0.45, -0.06, -0.45}, {0.45, 1.80, 0.45}}, 0.0125, 2.5),
                     translate({0, 0.045, 0}));
}

}  // namespace kiloband::generator
