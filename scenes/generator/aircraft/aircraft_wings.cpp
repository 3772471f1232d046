// Lifting surfaces from symmetric NACA four-digit sections, and what hangs on the wing tips.
#include "scenes/generator/aircraft/aircraft.hpp"

namespace kiloband::generator {
namespace {

/// One section: leading edge, chord (towards -z), thickness over chord.
struct Rib {
  Vec3 leading;
  double chord, thickness;
};

constexpr int kHalf = 44;  // points from the trailing to the leading edge
constexpr int kNose = 10;  // of them, those that belong to the leading-edge part

/// Half thickness over chord of the NACA 00xx section at x = distance from the leading edge / chord, closed
/// at the trailing edge (last coefficient -0.1036). Source: Abbott and von Doenhoff,
/// Theory of Wing Sections, 6.4.
double half_thickness(double x, double t) {
  return 5 * t * (0.2969 * std::sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - x * 0.1036))));
}

/// Closed ring, from the trailing edge over the side of `up` to the leading edge and back.
/// Spacing is by cosine.
Ring airfoil(const Rib& rib, Vec3 up) {
  Ring ring;
  for (int i = 0; i < 2 * kHalf; ++i) {
    const double x = i == 0 ? 1 : 0.5 * (1 + cosine(kPi * i / kHalf)), side = i < kHalf ? 1 : -1;
    const double h = i == 0 ? 0 : i == kHalf ? 0 : half_thickness(x, rib.thickness);
    ring.push_back(rib.leading + Vec3{0, 0, -x * rib.chord} + up * (side * h * rib.chord));
  }
  return ring;
}

/// Straight between the given ribs, closed at the tip by ribs that shrink to nothing over `round` metres.
std::vector<Rib> with_tip(const std::vector<Rib>& ribs, Vec3 outwards, double round) {
  std::vector<Rib> all;
  for (std::size_t i = 0; i + 1 < ribs.size(); ++i) {
    for (int s = 0; s < 8; ++s) {
      const double t = s / 8.0;
      all.push_back({mix(ribs[i].leading, ribs[i + 1].leading, t), mix(ribs[i].chord, ribs[i + 1].chord, t),
                     mix(ribs[i].thickness, ribs[i + 1].thickness, t)});
    }
  }
  const Rib tip = ribs.back();
  for (int s = 0; s <= 10; ++s) {
    const double a = kPi / 2 * s / 10, k = s == 10 ? 0 : cosine(a), cut = 0.25 * tip.chord * (1 - k);
    all.push_back({tip.leading + outwards * (round * sine(a)) + Vec3{0, 0, -cut}, tip.chord - 1.3 * cut,
                   tip.thickness * k});
  }
  return all;
}

/// Skin and leading edge of a surface that goes outwards from `ribs.front()`, on the +x side. The two parts
/// meet at equal points.
void add_surface(Parts& parts, const std::vector<Rib>& ribs, Vec3 outwards, Vec3 up, double round,
                 bool both_sides = true) {
  std::vector<Ring> skin, edge;
  for (const Rib& rib : with_tip(ribs, outwards, round)) {
    const Ring ring = airfoil(rib, up);
    edge.emplace_back(ring.begin() + kHalf - kNose, ring.begin() + kHalf + kNose + 1);
    Ring rest(ring.begin() + kHalf + kNose, ring.end());
    rest.insert(rest.end(), ring.begin(), ring.begin() + kHalf - kNose + 1);
    skin.push_back(rest);
  }
  const LoftOptions open{false, Ends::kOpen, 60};
  for (const auto& [name, rings] : {std::pair("skin", &skin), std::pair("leading_edges", &edge)}) {
    Mesh mesh = loft(*rings, open);
    // Which side a skin looks to: its upper half must look up.
    Vec3 towards;
    for (const auto& t : mesh.triangles) {
      const Vec3 p = mesh.positions[t[0]], n = cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p);
      towards = towards + n * (dot(p - ribs.front().leading, up) > 0 ? 1.0 : -1.0);
    }
    if (dot(towards, up) < 0) flip(mesh);
    append(parts[name], mesh);
    if (both_sides) append(parts[name], transformed(mesh, scale({-1, 1, 1})));
  }
}

void add_missile(Parts& parts, Vec3 at) {
  Mesh body = lathe({{0, 1.5},
                     {0.02, 1.48},
                     {0.045, 1.42},
                     {0.06, 1.33},
                     {0.0635, 1.2},
                     {0.0635, -1.45},
                     {0.055, -1.5},
                     {0, -1.5}},
                    40, false, 40);
  append(parts["stores"], transformed(body, translate(at) * rotate_x(90)));
  for (int i = 0; i < 4; ++i) {
    const Frame turn = translate(at) * rotate_z(45 + 90.0 * i);
    append(parts["stores"],
           transformed(rounded_box({0.012, 0.24, 0.42}, 0.004, 2), turn * translate({0, 0.17, -1.25})));
    append(parts["stores"],
           transformed(rounded_box({0.010, 0.14, 0.20}, 0.003, 2), turn * translate({0, 0.12, 1.05})));
  }
}

}  // namespace

void add_wings(Parts& parts) {
  constexpr double kY = 0.26;
  // Strake and wing: the strake shelters the intakes from above.
  add_surface(parts,
              {{{0.40, kY, 5.0}, 8.0, 0.010},
               {{0.74, kY, 4.0}, 7.0, 0.018},
               {{1.02, kY, 2.9}, 5.9, 0.028},
               {{1.32, kY, 1.5}, 4.5, 0.042},
               {{1.75, kY - 0.01, 0.95}, 3.98, 0.048},
               {{5.3, kY - 0.13, -2.5}, 1.0, 0.045}},
              {1, -0.035, 0}, {0, 1, 0}, 0.05);
  add_surface(parts, {{{0.90, 0.08, -4.3}, 2.5, 0.045}, {{2.75, 0.0, -6.1}, 1.0, 0.04}}, {1, -0.04, 0},
              {0, 1, 0}, 0.03);
  const double cant = 24 * kPi / 180;
  const Vec3 outwards{sine(cant), cosine(cant), 0}, normal{-cosine(cant), sine(cant), 0};
  const Vec3 root{0.82, 0.25, -2.9};
  add_surface(parts, {{root, 2.7, 0.05}, {root + outwards * 2.25 + Vec3{0, 0, -1.75}, 1.05, 0.045}}, outwards,
              normal, 0.03);
  for (const double side : {-1.0, 1.0}) {
    const Vec3 tip{side * 5.36, kY - 0.13, -2.7};
    append(parts["skin"], transformed(rounded_box({0.07, 0.09, 1.9}, 0.03, 4), translate(tip)));
    add_missile(parts, tip + Vec3{side * 0.10, -0.01, 0.15});
  }
}

}  // namespace kiloband::generator
