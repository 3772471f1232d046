#include "scenes/generator/statues/statues.hpp"

#include "scenes/generator/scenes.hpp"

namespace kiloband::generator {

Scene statues() {
  Scene scene{"statues", {}, {}};
  Parts& parts = scene.parts;
  add_hall(parts);
  add_landscape(parts);
  const auto put = [&](const std::string& part, const Mesh& mesh, const Pedestal& at, double degrees) {
    append(parts[part], transformed(mesh, translate({at.x, at.height, at.z}) * rotate_y(degrees)));
  };
  const Pedestal for_bust{-2.15, 0.55, 1.15, 0.24}, for_column{-1.05, -1.3, 0.45, 0.27},
      for_knot{0.05, 0.75, 0.95, 0.26}, for_figure{1.25, -0.9, 0.55, 0.46}, for_ball{2.45, 0.35, 0.80, 0.30};
  for (const Pedestal& p : {for_column, for_figure}) add_pedestal(parts, "pedestals_dark", p);
  for (const Pedestal& p : {for_bust, for_knot, for_ball}) add_pedestal(parts, "pedestals_light", p);
  put("bust", bust(), for_bust, 24);
  put("twisted_column", twisted_column(), for_column, 0);
  put("glass_knot", glass_knot(), for_knot, 8);
  put("veiled_figure", veiled_figure(), for_figure, -14);
  put("gyroid_ball", gyroid_ball(), for_ball, 0);
  add_statue_images(scene.images);
  return scene;
}

}  // namespace kiloband::generator
