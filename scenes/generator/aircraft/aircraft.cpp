#include "scenes/generator/aircraft/aircraft.hpp"

#include "scenes/generator/scenes.hpp"
#include "scenes/generator/sky.hpp"

namespace kiloband::generator {

Scene aircraft() {
  Scene scene{"aircraft", {}, {}};
  add_fuselage(scene.parts);
  add_intakes(scene.parts);
  add_nozzle(scene.parts);
  add_wings(scene.parts);
  add_plume(scene.parts);
  scene.images["sky.pfm"] = clear_sky({0.80, 0.26, -0.54}, 0.5);
  return scene;
}

}  // namespace kiloband::generator
