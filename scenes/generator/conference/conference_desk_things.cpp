// What lies on the table: laptops with their cables, notepads and pens, a conference phone.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

Mesh keys() {
  Mesh mesh;
  const Mesh key = rounded_box({0.0155, 0.003, 0.0150}, 0.0013, 2);
  const Mesh space = rounded_box({0.090, 0.003, 0.0150}, 0.0013, 2);
  for (int row = 0; row < 5; ++row) {
    const double z = -0.078 + row * 0.0185;
    for (int i = 0; i < 15; ++i) {
      if (row == 4 && i >= 4 && i <= 8) continue;
      append(mesh, transformed(key, translate({-0.1295 + i * 0.0185, 0.0085, z})));
    }
    if (row == 4) append(mesh, transformed(space, translate({-0.0185, 0.0085, z})));
  }
  return mesh;
}

/// Facing +z, towards whoever uses it.
void add_laptop(Parts& parts, const Frame& at, double lid_degrees) {
  append(parts["laptop_body"], transformed(rounded_box({0.32, 0.014, 0.22}, 0.006, 4), at));
  append(parts["laptop_keys"], transformed(keys(), at));
  append(parts["laptop_keys"],
         transformed(rounded_box({0.11, 0.0012, 0.07}, 0.0005, 2), at * translate({0, 0.0073, 0.068})));
  const Frame lid =
      at * translate({0, 0.009, -0.108}) * rotate_x(-lid_degrees + 90) * translate({0, 0.105, 0});
  append(parts["laptop_body"], transformed(rounded_box({0.32, 0.21, 0.007}, 0.003, 4), lid));
  append(parts["laptop_keys"],
         transformed(rounded_box({0.305, 0.195, 0.002}, 0.0008, 2), lid * translate({0, 0, 0.0032})));
  append(parts["laptop_screens"],
         transformed(picture({-0.144, 0.09, 0.0046}, {0.288, 0, 0}, {0, -0.18, 0}), lid));
}

void add_notepad(Parts& parts, const Frame& at, unsigned seed) {
  for (int sheet = 0; sheet < 3; ++sheet) {
    Mesh page = grid(10, 14, [&](double u, double v) {
      const double x = (u - 0.5) * 0.21, z = (0.5 - v) * 0.297;
      const double curl = 0.012 * smooth_step(0.3, 0.9, u) * smooth_step(0.5, 0.0, v) * (sheet == 2);
      return Vec3{x, 0.002 + 0.0015 * sheet + curl, z};
    });
    append(parts["paper"], transformed(page, at * rotate_y(3.0 * sheet * (random_number(seed, 1) - 0.5))));
  }
  const Frame lying =
      at * translate({0.05, 0.0095, 0.02}) * rotate_y(70 + 80 * random_number(seed, 2)) * rotate_z(90);
  append(parts["pens"], transformed(rounded_cylinder(0.0048, 0.125, 0.0015, 20), lying));
  append(parts["chair_metal"],
         transformed(lathe({{0, -0.018}, {0.001, -0.018}, {0.0045, 0}, {0, 0}}, 20), lying));
}

/// A three-armed conference phone.
void add_phone(Parts& parts, Vec3 at) {
  Mesh body = rounded_cylinder(0.12, 0.045, 0.016, 144, 6);
  deform(body, [](Vec3 p) {
    const double a = arctangent(p.z, p.x), r = std::sqrt(p.x * p.x + p.z * p.z);
    const double k = 1 + 0.28 * cosine(3 * a) * r / 0.12;
    return Vec3{p.x * k, p.y - 1.3 * r * r * (p.y > 0.02), p.z * k};
  });
  append(parts["black_plastic"], transformed(with_smooth_normals(body, 50), translate(at)));
  append(parts["chair_metal"],
         transformed(lathe({{0.05, 0}, {0.052, 0.003}, {0.05, 0.006}, {0.047, 0.003}}, 64, true, 180),
                     translate(at + Vec3{0, 0.041, 0})));
}

/// From a laptop's side to the nearest outlet, hanging a little like a cable.
void add_cable(Parts& parts, Vec3 from, Vec3 to, unsigned seed) {
  const Vec3 middle = mix(from, to, 0.5), side = normalize(cross(to - from, {0, 1, 0}));
  const double swing = 0.16 * (random_number(seed, 3) - 0.5);
  const double y = kTableHeight + 0.004;
  const auto flat = [&](Vec3 p) { return Vec3{p.x, y, p.z}; };
  append(parts["cables"], tube(
                              smooth_curve({from, flat(mix(from, to, 0.15)), flat(middle + side * swing),
                                            flat(mix(from, to, 0.8) - side * swing), flat(to)},
                                           14),
                              [](double) { return 0.0032; }, 10));
}

}  // namespace

void add_desk_things(Parts& parts) {
  for (int i = 0; i < kSeats; ++i) {
    const Seat s = seat(i);
    const auto counter = static_cast<unsigned>(i);
    const Frame place =
        translate({s.x, kTableHeight, s.z}) * rotate_y(s.degrees + 10 * (random_number(21, counter) - 0.5));
    // Local: the sitter looks along +z; what lies before them is at z > 0.3 and faces -z.
    if (i == 1 || i == 2 || i == 4 || i == 7 || i == 8 || i == 11) {
      const Frame at = place * translate({0, 0.0075, 0.46}) * rotate_y(180);
      add_laptop(parts, at, 108 + 14 * random_number(22, counter));
      const double outlet = s.x < -0.6 ? -1.2 : s.x > 0.6 ? 1.2 : 0.0;
      add_cable(parts, at.point({0.16, 0, -0.06}), {outlet, kTableHeight, s.z > 0 ? 0.05 : -0.05}, counter);
      if (i % 3 != 2) continue;
    }
    const bool beside = i == 1 || i == 2 || i == 4 || i == 7 || i == 8 || i == 11;
    add_notepad(parts,
                place * translate({beside ? 0.27 : 0.02, 0, 0.43}) *
                    rotate_y(180 + 20 * (random_number(23, counter) - 0.5)),
                40 + counter);
  }
  add_phone(parts, {0.55, kTableHeight, 0.0});
  add_phone(parts, {-1.7, kTableHeight, 0.0});
}

}  // namespace kiloband::generator
