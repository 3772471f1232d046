// The wall with three windows, their frames and blinds, and what is seen outside.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

constexpr double kSill = 0.85, kHead = 2.5, kHalfWidth = 1.15, kDepth = 0.25;
constexpr double kWall = -kRoomZ / 2;  // z of the wall's inner face
constexpr double kCentres[] = {-2.85, 0, 2.85};

Mesh box(Vec3 low, Vec3 high, double edge = 0.004) {
  return transformed(rounded_box(high - low, edge, 1), translate((low + high) * 0.5));
}

void add_wall(Parts& parts) {
  const double x = kRoomX / 2 + 0.2;
  append(parts["walls"], box({-x, -0.1, kWall - kDepth}, {x, kSill, kWall}));
  append(parts["walls"], box({-x, kHead, kWall - kDepth}, {x, kRoomY + 0.1, kWall}));
  double left = -x;
  for (const double centre : kCentres) {
    append(parts["walls"],
           box({left, kSill - 0.01, kWall - kDepth}, {centre - kHalfWidth, kHead + 0.01, kWall}));
    left = centre + kHalfWidth;
  }
  append(parts["walls"], box({left, kSill - 0.01, kWall - kDepth}, {x, kHead + 0.01, kWall}));
}

void add_frame(Parts& parts, double centre) {
  const double z = kWall - 0.16;
  Mesh& frame = parts["window_frames"];
  const auto bar = [&](double x0, double x1, double y0, double y1, double depth) {
    append(frame, box({centre + x0, y0, z - depth / 2}, {centre + x1, y1, z + depth / 2}, 0.006));
  };
  const double w = kHalfWidth;
  bar(-w, w, kSill, kSill + 0.06, 0.07);
  bar(-w, w, kHead - 0.06, kHead, 0.07);
  bar(-w, -w + 0.06, kSill, kHead, 0.07);
  bar(w - 0.06, w, kSill, kHead, 0.07);
  bar(-0.035, 0.035, kSill, kHead, 0.07);
  for (const double side : {-1.0, 1.0}) {  // sashes
    const double a = side < 0 ? -w + 0.06 : 0.035, b = side < 0 ? -0.035 : w - 0.06;
    bar(a, b, kSill + 0.06, kSill + 0.105, 0.05);
    bar(a, b, kHead - 0.105, kHead - 0.06, 0.05);
    bar(a, a + 0.045, kSill + 0.06, kHead - 0.06, 0.05);
    bar(b - 0.045, b, kSill + 0.06, kHead - 0.06, 0.05);
    const Vec3 hinge{centre + side * 0.06, 0.5 * (kSill + kHead), z + 0.03};
    append(parts["door_metal"],
           tube(
               smooth_curve({hinge, hinge + Vec3{0, 0, 0.035}, hinge + Vec3{0, -0.05, 0.045},
                             hinge + Vec3{0, -0.12, 0.045}},
                            6),
               [](double) { return 0.008; }, 12));
  }
  append(parts["window_sills"], box({centre - w - 0.05, kSill - 0.03, kWall - 0.12},
                                    {centre + w + 0.05, kSill, kWall + 0.09}, 0.01));
}

/// A bent strip, tilted about its long axis.
Mesh slat(double length, double tilt_degrees) {
  const Mesh strip = grid(8, 6, [&](double u, double v) {
    const double a = (v - 0.5) * 1.0;
    return Vec3{(u - 0.5) * length, 0.025 * (cosine(a) - 1), 0.048 * (0.5 - v)};
  });
  return transformed(strip, rotate_x(tilt_degrees));
}

/// Slats every 42 mm from the head rail down to `bottom`, the rest lies stacked there.
void add_blind(Parts& parts, double centre, double bottom, double tilt_degrees) {
  const double z = kWall - 0.07, length = 2 * kHalfWidth - 0.06, top = kHead - 0.05;
  append(parts["blind_rails"],
         box({centre - length / 2, top, z - 0.025}, {centre + length / 2, kHead, z + 0.025}));
  const Mesh one = slat(length, tilt_degrees), flat = slat(length, 0);
  int count = 0;
  double y = top - 0.03;
  for (; y > bottom; y -= 0.042, ++count)
    append(parts["blinds"], transformed(one, translate({centre, y, z})));
  for (; count < 37; ++count, y -= 0.004)
    append(parts["blinds"], transformed(flat, translate({centre, y, z})));
  append(parts["blind_rails"],
         box({centre - length / 2, y - 0.02, z - 0.025}, {centre + length / 2, y, z + 0.025}, 0.005));
  for (const double x : {-0.75, 0.0, 0.75}) {
    for (const double side : {-0.026, 0.026}) {
      append(parts["blind_cords"],
             tube(
                 {{centre + x, top, z + side}, {centre + x, y, z + side}}, [](double) { return 0.0012; }, 6));
    }
  }
  append(parts["blind_cords"], tube(
                                   {{centre + 1.0, top, z + 0.035}, {centre + 1.0, 1.3, z + 0.035}},
                                   [](double) { return 0.004; }, 10));
}

void add_radiator(Parts& parts, double centre) {
  for (int i = 0; i < 24; ++i) {
    const double x = centre + (i - 11.5) * 0.07;
    append(parts["radiators"],
           transformed(rounded_box({0.055, 0.5, 0.05}, 0.02, 3), translate({x, 0.42, kWall + 0.06})));
  }
  for (const double y : {0.2, 0.64}) {
    append(parts["radiators"], tube(
                                   {{centre - 0.85, y, kWall + 0.06}, {centre + 0.85, y, kWall + 0.06}},
                                   [](double) { return 0.016; }, 16));
  }
}

}  // namespace

void add_windows(Parts& parts) {
  add_wall(parts);
  for (const double centre : kCentres) {
    add_frame(parts, centre);
    add_radiator(parts, centre);
  }
  add_blind(parts, kCentres[0], 0.95, 38);
  add_blind(parts, kCentres[1], 1.75, 24);
  add_blind(parts, kCentres[2], 1.35, 30);
  // What is outside: a picture that emits, as an overcast sky does. One piece behind each window: light that
  // the room would not see is not sampled either.
  for (const double centre : kCentres) {
    Mesh view = picture({centre - kHalfWidth - 0.05, kHead + 0.05, kWall - 0.3}, {2 * kHalfWidth + 0.1, 0, 0},
                        {0, kSill - kHead - 0.1, 0});
    for (Vec2& uv : view.uvs) uv.x = (uv.x + (centre - kCentres[0]) / (kCentres[1] - kCentres[0])) / 3;
    append(parts["outside"], view);
  }
}

}  // namespace kiloband::generator
