// Sculptures given by formulas: a twisted column, a gyroid cut out of a ball, a knot.
#include "scenes/generator/implicit.hpp"
#include "scenes/generator/primitives.hpp"
#include "scenes/generator/statues/statues.hpp"

namespace kiloband::generator {

/// Four strands that wind about each other, between a base and a capital that carries a ball.
Mesh twisted_column() {
  constexpr double kHeight = 1.5;
  Mesh mesh;
  std::vector<Ring> rings;
  constexpr int kRows = 220, kColumns = 120;
  for (int r = 0; r <= kRows; ++r) {
    const double t = static_cast<double>(r) / kRows, twist = 2 * kPi * 1.25 * t;
    const double ends = smooth_step(0, 0.06, t) * smooth_step(1, 0.94, t),
                 base = 0.105 + 0.02 * sine(kPi * t);
    Ring ring;
    for (int c = 0; c < kColumns; ++c) {
      const double a = 2 * kPi * c / kColumns, lobe = std::fabs(cosine(2 * (a - twist)));
      const double radius = base + ends * (0.050 * std::sqrt(lobe * lobe + 0.01) - 0.022);
      ring.push_back({radius * cosine(a), 0.12 + kHeight * t, radius * sine(a)});
    }
    rings.push_back(ring);
  }
  append(mesh, loft(rings, {true, Ends::kCapped, 75}));
  const std::vector<Vec2> base{{0, 0},         {0.19, 0},      {0.195, 0.006}, {0.195, 0.035}, {0.185, 0.042},
                               {0.19, 0.055},  {0.185, 0.072}, {0.165, 0.082}, {0.150, 0.086}, {0.145, 0.100},
                               {0.150, 0.112}, {0.145, 0.122}, {0.125, 0.127}, {0, 0.130}};
  append(mesh, lathe(base, 120, false, 50));
  append(mesh,
         transformed(lathe(base, 120, false, 50), translate({0, kHeight + 0.24, 0}) * scale({1, -1, 1})));
  append(mesh, ball({0, kHeight + 0.24 + 0.15, 0}, 0.16, 72));
  return mesh;
}

/// One of the two labyrinths that the gyroid sin x cos y + sin y cos z + sin z cos x = 0 divides space
/// into, inside a ball.
Mesh gyroid_ball() {
  constexpr double kRadius = 0.42, kPeriod = 0.30;
  const Field field = [](Vec3 p) {
    const Vec3 q = p * (2 * kPi / kPeriod);
    const double g = sine(q.x) * cosine(q.y) + sine(q.y) * cosine(q.z) + sine(q.z) * cosine(q.x);
    const double wall = (g + 0.15) * kPeriod / (2 * kPi) / 1.5;
    const double core = sphere_distance(p, {}, 0.12);
    return blend_intersection(blend(wall, core, 0.02), sphere_distance(p, {}, kRadius), 0.035);
  };
  const double r = kRadius + 0.02;
  const Mesh mesh = surface_of(field, {{-r, -r, -r}, {r, r, r}}, 0.0115, 1.3);
  return transformed(mesh, translate({0, kRadius, 0}) * rotate_x(20) * rotate_z(35));
}

/// A trefoil that winds three times through and twice around a torus that stands upright; its section is
/// flattened and turns with the torus, so that it closes.
Mesh glass_knot() {
  constexpr double kMajor = 0.27, kMinor = 0.115;
  constexpr int kAlong = 720, kAround = 64;
  const auto place = [](double t) {
    const double r = kMajor + kMinor * cosine(3 * t);
    return Vec3{r * cosine(2 * t), r * sine(2 * t), 1.25 * kMinor * sine(3 * t)};
  };
  std::vector<Ring> rings;
  for (int i = 0; i < kAlong; ++i) {
    const double t = 2 * kPi * i / kAlong;
    const Vec3 along = normalize(place(t + 1e-4) - place(t - 1e-4));
    const Vec3 middle{kMajor * cosine(2 * t), kMajor * sine(2 * t), 0};
    const Vec3 out = normalize(place(t) - middle), right = normalize(out - along * dot(out, along)),
               up = cross(along, right);
    Ring ring;
    for (int k = 0; k < kAround; ++k) {
      const double a = 2 * kPi * k / kAround;
      ring.push_back(place(t) + right * (0.058 * cosine(a)) + up * (0.072 * sine(a)));
    }
    rings.push_back(ring);
  }
  const Mesh mesh = loft(rings, {true, Ends::kJoined, 180});
  double low = 0;
  for (const Vec3& p : mesh.positions) low = std::min(low, p.y);
  return transformed(mesh, translate({0, -low, 0}));
}

}  // namespace kiloband::generator
