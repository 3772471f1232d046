// Floor, walls, panelling, ceiling.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/primitives.hpp"

namespace kiloband::generator {
namespace {

Mesh box(Vec3 low, Vec3 high, double edge = 0.004) {
  return transformed(rounded_box(high - low, edge, 1), translate((low + high) * 0.5));
}

/// Strips of wood on a dark board, as acoustic panels are made, at the wall of the screen.
void add_panelling(Parts& parts, double z0, double z1) {
  const double x = kRoomX / 2;
  append(parts["panel_felt"], box({x - 0.02, 0.1, z0}, {x, kRoomY - 0.02, z1}));
  constexpr double kPitch = 0.05, kWidth = 0.034;
  for (double z = z0 + 0.01; z + kWidth < z1; z += kPitch) {
    Mesh slat = box({x - 0.045, 0.1, z}, {x - 0.02, kRoomY - 0.02, z + kWidth}, 0.003);
    project_uvs(slat, {0, 1.0, 0}, {0, 0, 1.7});
    append(parts["panel_slats"], slat);
  }
}

void add_skirting(Parts& parts) {
  const double x = kRoomX / 2, z = kRoomZ / 2;
  append(parts["skirting"], box({-x, 0, z - 0.015}, {x, 0.09, z}));
  append(parts["skirting"], box({-x, 0, -z}, {x, 0.09, -z + 0.015}));
  append(parts["skirting"], box({-x, 0, -z}, {-x + 0.015, 0.09, z}));
  append(parts["skirting"], box({x - 0.015, 0, -z}, {x, 0.09, z}));
}

bool is_luminaire(int i, int j) {
  return (i == 2 || i == 5 || i == 9 || i == 12) && (j == 2 || j == 5 || j == 8);
}

/// A trim of four bars around the light of a tile; the light itself is a rectangle of the scene file.
void add_luminaire(Parts& parts, Vec3 centre) {
  constexpr double kHalf = 0.2925, kBar = 0.022;
  for (const double s : {-1.0, 1.0}) {
    const double a = s * (kHalf - kBar / 2);
    append(parts["luminaire_trim"],
           box(centre + Vec3{-kHalf, -0.012, a - kBar / 2}, centre + Vec3{kHalf, 0.04, a + kBar / 2}, 0.003));
    append(parts["luminaire_trim"],
           box(centre + Vec3{a - kBar / 2, -0.012, -kHalf}, centre + Vec3{a + kBar / 2, 0.04, kHalf}, 0.003));
  }
  append(parts["luminaires"], grid(1, 1, [&](double u, double v) {
           return centre + Vec3{(2 * u - 1) * (kHalf - kBar), 0.02, (2 * v - 1) * (kHalf - kBar)};
         }));
}

}  // namespace

void add_room(Parts& parts) {
  const double x = kRoomX / 2, z = kRoomZ / 2;
  Mesh floor = grid(1, 1, [&](double u, double v) { return Vec3{(2 * u - 1) * x, 0, (1 - 2 * v) * z}; });
  project_uvs(floor, {1, 0, 0}, {0, 0, 1});
  append(parts["floor"], floor);
  append(parts["walls"], box({-x - 0.2, -0.1, z}, {x + 0.2, kRoomY + 0.1, z + 0.2}));
  append(parts["walls"], box({-x - 0.2, -0.1, -z}, {-x, kRoomY + 0.1, z}));
  append(parts["accent_wall"], box({x, -0.1, -z}, {x + 0.2, kRoomY + 0.1, z}));
  append(parts["ceiling_void"], box({-x - 0.2, kRoomY + 0.1, -z - 0.3}, {x + 0.2, kRoomY + 0.2, z + 0.2}));
  add_panelling(parts, -z, -1.75);
  add_panelling(parts, 1.75, 1.75 + 0.25);
  add_skirting(parts);
}

/// Tiles of 60 cm in a grid of T bars; some are lights.
void add_ceiling(Parts& parts) {
  constexpr double kTile = 0.6;
  const Mesh tile = rounded_box({kTile - 0.016, 0.02, kTile - 0.016}, 0.006, 2);
  const Mesh bar_x = rounded_box({kRoomX, 0.012, 0.022}, 0.002, 1);
  const Mesh bar_z = rounded_box({0.022, 0.012, kRoomZ}, 0.002, 1);
  for (int i = 0; i < 15; ++i) {
    for (int j = 0; j < 11; ++j) {
      const Vec3 centre{-kRoomX / 2 + (i + 0.5) * kTile, kRoomY + 0.012, -kRoomZ / 2 + (j + 0.5) * kTile};
      if (is_luminaire(i, j)) {
        add_luminaire(parts, centre);
      } else {
        append(parts["ceiling_tiles"], transformed(tile, translate(centre)));
      }
    }
  }
  for (int i = 0; i <= 15; ++i) {
    append(parts["ceiling_grid"],
           transformed(bar_z, translate({-kRoomX / 2 + i * kTile, kRoomY + 0.008, 0})));
  }
  for (int j = 0; j <= 11; ++j) {
    append(parts["ceiling_grid"],
           transformed(bar_x, translate({0, kRoomY + 0.008, -kRoomZ / 2 + j * kTile})));
  }
}

}  // namespace kiloband::generator
