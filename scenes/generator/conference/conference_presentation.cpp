// The end of the room that everybody looks at: screen, projector, whiteboard, door.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

Mesh box(Vec3 low, Vec3 high, double edge = 0.004, int segments = 1) {
  return transformed(rounded_box(high - low, edge, segments), translate((low + high) * 0.5));
}

/// A flat display of 3.0 x 1.69 m on the wall at +x; uv over the picture, which looks to -x.
void add_display(Parts& parts) {
  const double x = kRoomX / 2, w = 1.5, y0 = 0.85, y1 = y0 + 2 * w * 9 / 16;
  append(parts["display_frame"], box({x - 0.07, y0 - 0.02, -w - 0.02}, {x, y1 + 0.02, w + 0.02}, 0.01, 3));
  append(parts["display"], picture({x - 0.0715, y1, -w}, {0, 0, 2 * w}, {0, y0 - y1, 0}));
  append(parts["speakers"], box({x - 0.09, y0 - 0.16, -0.6}, {x - 0.001, y0 - 0.06, 0.6}, 0.02, 4));
}

/// Ceiling projector with lens, vents and a pole.
void add_projector(Parts& parts) {
  const Vec3 at{0.9, 2.38, 0};
  append(parts["white_plastic"], transformed(rounded_box({0.34, 0.12, 0.42}, 0.03, 5), translate(at)));
  append(parts["projector_lens"], ball(at + Vec3{0.155, 0.0, 0.1}, 0.042, 24));
  append(parts["black_plastic"], transformed(rounded_cylinder(0.055, 0.03, 0.006, 40),
                                             translate(at + Vec3{0.16, 0, 0.1}) * rotate_z(-90)));
  for (int i = 0; i < 12; ++i) {
    append(parts["black_plastic"],
           box(at + Vec3{-0.12 + i * 0.02, -0.03, 0.2}, at + Vec3{-0.11 + i * 0.02, 0.03, 0.212}, 0.002));
  }
  append(parts["display_frame"],
         transformed(rounded_cylinder(0.025, 0.4, 0.004, 32), translate(at + Vec3{0, 0.04, 0})));
  append(parts["display_frame"],
         transformed(rounded_cylinder(0.09, 0.015, 0.004, 40), translate(at + Vec3{0, 0.39, 0})));
}

/// On the wall at +z, with a tray, pens and a sponge.
void add_whiteboard(Parts& parts) {
  const double z = kRoomZ / 2;
  Mesh board = box({-1.4, 0.95, z - 0.025}, {1.4, 2.15, z - 0.005}, 0.003);
  append(parts["whiteboard"], board);
  for (const double y : {0.93, 2.15})
    append(parts["window_frames"], box({-1.42, y, z - 0.03}, {1.42, y + 0.02, z}, 0.005));
  for (const double x : {-1.42, 1.4})
    append(parts["window_frames"], box({x, 0.93, z - 0.03}, {x + 0.02, 2.17, z}, 0.005));
  append(parts["window_frames"], box({-0.5, 0.9, z - 0.1}, {0.5, 0.92, z}, 0.006, 2));
  for (int i = 0; i < 4; ++i) {
    append(parts["pens"], transformed(rounded_cylinder(0.009, 0.13, 0.003, 20),
                                      translate({-0.35 + i * 0.17, 0.93, z - 0.06}) * rotate_z(90)));
  }
}

/// Leaf, frame, lever handle; in the wall at +x beside the display.
void add_door(Parts& parts) {
  const double x = kRoomX / 2, z0 = 2.12, z1 = 3.02, top = 2.1;
  Mesh leaf = box({x - 0.03, 0.01, z0}, {x + 0.01, top, z1}, 0.006, 2);
  project_uvs(leaf, {0, 1.0, 0}, {0, 0, 1.0});
  append(parts["door_leaf"], leaf);
  append(parts["display_frame"], box({x - 0.04, 0, z0 - 0.07}, {x, top + 0.07, z0}, 0.008, 2));
  append(parts["display_frame"], box({x - 0.04, 0, z1}, {x, top + 0.07, z1 + 0.07}, 0.008, 2));
  append(parts["display_frame"], box({x - 0.04, top, z0 - 0.07}, {x, top + 0.07, z1 + 0.07}, 0.008, 2));
  const Vec3 handle{x - 0.03, 1.05, z0 + 0.08};
  append(parts["door_metal"],
         transformed(rounded_cylinder(0.026, 0.01, 0.003, 32), translate(handle) * rotate_z(90)));
  append(parts["door_metal"],
         tube(
             smooth_curve({handle, handle + Vec3{-0.045, 0, 0}, handle + Vec3{-0.055, 0, 0.02},
                           handle + Vec3{-0.055, 0, 0.13}},
                          10),
             [](double) { return 0.0095; }, 20));
  append(parts["white_plastic"], box({x - 0.012, 1.05, 1.86}, {x - 0.001, 1.13, 1.94}, 0.004, 3));
  append(parts["white_plastic"], box({x - 0.018, 1.06, 1.87}, {x - 0.008, 1.12, 1.93}, 0.004, 3));
}

}  // namespace

void add_presentation(Parts& parts) {
  add_display(parts);
  add_projector(parts);
  add_whiteboard(parts);
  add_door(parts);
}

}  // namespace kiloband::generator
