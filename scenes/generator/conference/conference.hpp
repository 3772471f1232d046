// The conference room: x along the table (screen at +x), y up, z across (windows at -z),
// origin on the floor in the middle.
#pragma once

#include "scenes/generator/image.hpp"
#include "scenes/generator/mesh.hpp"

namespace kiloband::generator {

inline constexpr double kRoomX = 9.0, kRoomY = 2.8, kRoomZ = 6.6;
inline constexpr double kTableHeight = 0.74;

void add_room(Parts& parts);
void add_ceiling(Parts& parts);
void add_windows(Parts& parts);
void add_presentation(Parts& parts);  // screen, projector, whiteboard, door
void add_table(Parts& parts);
void add_chairs(Parts& parts);
void add_desk_things(Parts& parts);
void add_drinks(Parts& parts);
void add_plants(Parts& parts);
void add_conference_images(Images& images);

/// Half the table's width at x, without its round corners.
double table_half_width(double x);
inline constexpr double kTableHalfLength = 2.7;

/// Where people sit: on the floor, at the table's edge, and the direction in degrees about y
/// that they face (0: +z).
struct Seat {
  double x, z, degrees;
};
inline constexpr int kSeats = 14;
Seat seat(int i);

}  // namespace kiloband::generator
