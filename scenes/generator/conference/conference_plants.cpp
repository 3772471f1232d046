// Two potted plants: long bent leaves on stems.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

/// A leaf that starts at the origin along +z and bends down, folded a little along its midrib.
Mesh leaf(double length, double width, double droop) {
  return grid(8, 16, [&](double u, double v) {
    const double side = 2 * u - 1, outline = power(sine(kPi * power(v, 0.75)), 0.8) * (1 - 0.15 * v);
    const double x = side * width / 2 * outline, z = length * v * (1 - 0.12 * v * droop);
    const double y =
        -droop * length * v * v * 0.6 + 0.25 * std::fabs(x) + 0.004 * sine(14 * v) * side * outline;
    return Vec3{-x, y, z};
  });
}

void add_plant(Parts& parts, Vec3 at, double height, unsigned seed) {
  append(parts["pots"], transformed(lathe({{0, 0},
                                           {0.14, 0},
                                           {0.15, 0.01},
                                           {0.185, 0.33},
                                           {0.19, 0.345},
                                           {0.18, 0.35},
                                           {0.172, 0.34},
                                           {0.165, 0.29},
                                           {0, 0.29}},
                                          72, false, 50),
                                    translate(at)));
  append(parts["soil"],
         transformed(lathe({{0, 0.315}, {0.06, 0.312}, {0.12, 0.305}, {0.1655, 0.298}}, 48, false, 180),
                     translate(at)));
  unsigned k = 0;
  const auto draw = [&] { return random_number(seed, k++); };
  for (int stem = 0; stem < 6; ++stem) {
    const double a = 360 * (stem + 0.5 * draw()) / 6, lean = 0.10 + 0.16 * draw(),
                 tall = height * (0.55 + 0.45 * draw());
    const Frame turn = translate(at + Vec3{0, 0.3, 0}) * rotate_y(a);
    const std::vector<Vec3> curve = smooth_curve(
        {{0, 0, 0.03}, {0, 0.35 * tall, 0.03 + 0.3 * lean}, {0, 0.7 * tall, 0.6 * lean}, {0, tall, lean}},
        10);
    append(parts["stems"], transformed(tube(
                                           curve, [](double t) { return 0.009 - 0.006 * t; }, 10),
                                       turn));
    constexpr int kLeaves = 17;
    for (int i = 0; i < kLeaves; ++i) {
      const double t = 0.22 + 0.78 * i / (kLeaves - 1);
      const Vec3 foot = curve[static_cast<std::size_t>(t * static_cast<double>(curve.size() - 1))];
      const double size = (0.20 + 0.18 * draw()) * (1.05 - 0.45 * t), spin = 137.5 * i + 40 * draw();
      const double rise = 15 + 45 * t + 15 * draw(), droop = 0.9 + 0.9 * draw();
      append(parts["leaves"], transformed(leaf(size, 0.30 * size, droop),
                                          turn * translate(foot) * rotate_y(spin) * rotate_x(-rise)));
    }
  }
}

}  // namespace

void add_plants(Parts& parts) {
  add_plant(parts, {kRoomX / 2 - 0.42, 0, -kRoomZ / 2 + 0.45}, 1.25, 71);
  add_plant(parts, {-1.42, 0, -kRoomZ / 2 + 0.40}, 0.95, 72);
}

}  // namespace kiloband::generator
