// The hall of statues: x to the right, y up, the visitor looks along -z. Sculptures stand on pedestals.
#pragma once

#include "scenes/generator/image.hpp"
#include "scenes/generator/mesh.hpp"

namespace kiloband::generator {

/// The sculptures, each standing on y = 0 about the origin and facing +z.
Mesh bust();           // 0.8 m
Mesh veiled_figure();  // 1.75 m
Mesh twisted_column();
Mesh gyroid_ball();  // touches y = 0
Mesh glass_knot();

void add_hall(Parts& parts);
void add_landscape(Parts& parts);
void add_statue_images(Images& images);

/// Pedestals: height in metres, half of the width of the top.
struct Pedestal {
  double x, z, height, half;
};
void add_pedestal(Parts& parts, const std::string& part, const Pedestal& at);

}  // namespace kiloband::generator
