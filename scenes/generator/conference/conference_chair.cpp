// A swivel chair: upholstered seat and back, arms, gas spring, five-star base on twin casters. Local frame:
// on the floor under the spring, facing +z.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

/// Cushion with a hollow for the sitter and a front edge that falls off.
Mesh seat_cushion() {
  Mesh mesh = rounded_box_raw({0.50, 0.085, 0.49}, 0.036, 5, 12);
  deform(mesh, [](Vec3 p) {
    const double across = 2 * p.x / 0.5, top = smooth_step(-0.02, 0.04, p.y);
    p.y += top * (-0.016 * smooth_step(1, 0, std::fabs(across)) * smooth_step(-0.26, -0.1, p.z));
    p.y -= 0.045 * smooth_step(0.08, 0.30, p.z);
    p.y += 0.012 * across * across;
    p.x *= 1 - 0.06 * smooth_step(0.05, -0.25, p.z);
    return p;
  });
  return transformed(with_smooth_normals(mesh, 180), translate({0, 0.475, 0.02}));
}

/// Cushion of the back: bent around the sitter, with a lumbar bulge, leaning back.
Mesh back_cushion() {
  Mesh mesh = rounded_box_raw({0.47, 0.52, 0.062}, 0.028, 5, 14);
  deform(mesh, [](Vec3 p) {
    const double t = p.y / 0.52;
    p.x *= 1 - 0.16 * smooth_step(0.0, 0.55, t) - 0.10 * smooth_step(0.1, -0.5, t);
    p.z += 0.75 * p.x * p.x + 0.03 * exponential(-20 * (t + 0.2) * (t + 0.2)) +
           0.03 * smooth_step(0.2, 0.5, t) - 0.02 * smooth_step(-0.3, 0.5, t);
    return p;
  });
  return transformed(with_smooth_normals(mesh, 180), translate({0, 0.795, -0.245}) * rotate_x(-11));
}

/// Seams: a cord along the edge of both cushions is what makes them read as upholstery.
Mesh seat_piping() {
  std::vector<Vec3> curve;
  for (int i = 0; i < 64; ++i) {
    const double a = 2 * kPi * i / 64, c = cosine(a), s = sine(a);
    const double k = 1 / power(power(std::fabs(c), 6) + power(std::fabs(s), 6), 1.0 / 6);
    const double x = 0.249 * c * k, z = 0.244 * s * k;
    const double narrow = 1 - 0.06 * smooth_step(0.05, -0.25, z);
    curve.push_back({x * narrow, 0.475 + 0.012 * 16 * x * x - 0.045 * smooth_step(0.08, 0.30, z), z + 0.02});
  }
  return tube(
      curve, [](double) { return 0.0045; }, 8, Ends::kJoined);
}

Mesh caster() {
  Mesh mesh;
  const Mesh wheel = transformed(rounded_cylinder(0.028, 0.019, 0.006, 24), rotate_z(90));
  for (const double x : {0.004, 0.025}) append(mesh, transformed(wheel, translate({x - 0.005, 0.028, 0})));
  append(mesh, transformed(rounded_cylinder(0.007, 0.05, 0.002, 14), translate({0, 0.03, 0})));
  return mesh;
}

void add_base(Mesh& metal, Mesh& casters) {
  std::vector<Vec2> arm;
  for (int i = 0; i < 16; ++i) {
    const double a = 2 * kPi * i / 16;
    arm.push_back({0.021 * cosine(a), 0.014 * sine(a)});
  }
  for (int k = 0; k < 5; ++k) {
    const double a = 72.0 * k + 18;
    const std::vector<Vec3> curve =
        smooth_curve({{0, 0.105, 0.02}, {0, 0.112, 0.10}, {0, 0.095, 0.22}, {0, 0.076, 0.32}}, 6);
    append(metal, transformed(sweep(curve, arm, {1, 0, 0}), rotate_y(a)));
    append(casters, transformed(caster(), rotate_y(a) * translate({0, 0, 0.305}) * rotate_y(40.0 * k)));
  }
  append(metal, transformed(rounded_cylinder(0.045, 0.06, 0.008, 32), translate({0, 0.08, 0})));
  append(metal, transformed(rounded_cylinder(0.019, 0.34, 0.002, 28), translate({0, 0.1, 0})));
}

Mesh frame_plastic() {
  Mesh mesh = transformed(rounded_cylinder(0.031, 0.16, 0.004, 28), translate({0, 0.13, 0}));
  append(mesh, transformed(rounded_box({0.17, 0.045, 0.26}, 0.014, 3), translate({0, 0.415, 0})));
  const std::vector<Vec2> bar{{0.035, 0.006},   {0.028, 0.012},   {-0.028, 0.012}, {-0.035, 0.006},
                              {-0.035, -0.006}, {-0.028, -0.012}, {0.028, -0.012}, {0.035, -0.006}};
  append(
      mesh,
      sweep(
          smooth_curve(
              {{0, 0.41, -0.1}, {0, 0.41, -0.24}, {0, 0.47, -0.315}, {0, 0.65, -0.30}, {0, 0.80, -0.305}}, 8),
          bar, {1, 0, 0}));
  for (const double side : {-1.0, 1.0}) {
    const std::vector<Vec3> curve = smooth_curve({{side * 0.1, 0.425, 0},
                                                  {side * 0.24, 0.425, 0},
                                                  {side * 0.30, 0.45, 0},
                                                  {side * 0.305, 0.55, -0.01},
                                                  {side * 0.30, 0.665, 0}},
                                                 8);
    append(mesh, tube(
                     curve, [](double t) { return 0.016 - 0.003 * t; }, 14));
    Mesh pad = rounded_box_raw({0.075, 0.032, 0.27}, 0.014, 4, 4);
    deform(pad, [](Vec3 p) { return Vec3{p.x * (1 - 0.8 * p.z * p.z / 0.07), p.y - 0.25 * p.z * p.z, p.z}; });
    append(mesh, transformed(with_smooth_normals(pad, 180), translate({side * 0.30, 0.675, 0.02})));
  }
  return mesh;
}

}  // namespace

Seat seat(int i) {
  if (i >= 12)
    return {i == 12 ? -kTableHalfLength - 0.28 : kTableHalfLength + 0.28, 0, i == 12 ? 90.0 : -90.0};
  const int place = i / 2;
  const double x = -2.0 + 0.8 * place, side = i % 2 ? 1 : -1;
  return {x, side * (table_half_width(x) + 0.22), side < 0 ? 0.0 : 180.0};
}

void add_chairs(Parts& parts) {
  Mesh fabric = seat_cushion(), piping = seat_piping(), metal, casters;
  append(fabric, back_cushion());
  add_base(metal, casters);
  const Mesh plastic = frame_plastic();
  for (int i = 0; i < kSeats; ++i) {
    const Seat s = seat(i);
    const auto jitter = [&](unsigned k, double amount) {
      return amount * (2 * random_number(11, static_cast<unsigned>(i) * 8 + k) - 1);
    };
    const double back = 0.06 + jitter(0, 0.07);
    const Frame heading = rotate_y(s.degrees + jitter(1, 24));
    const Frame at =
        translate(Vec3{s.x + jitter(2, 0.05), 0, s.z} - rotate_y(s.degrees).direction({0, 0, back}));
    append(parts["chair_fabric"], transformed(fabric, at * heading));
    append(parts["chair_piping"], transformed(piping, at * heading));
    append(parts["chair_plastic"], transformed(plastic, at * heading));
    const Frame turned = rotate_y(jitter(3, 36));
    append(parts["chair_metal"], transformed(metal, at * turned));
    append(parts["chair_casters"], transformed(casters, at * turned));
  }
}

}  // namespace kiloband::generator
