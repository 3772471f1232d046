#include "scenes/generator/conference/conference.hpp"

#include "scenes/generator/scenes.hpp"

namespace kiloband::generator {

Scene conference() {
  Scene scene{"conference", {}, {}};
  add_room(scene.parts);
  add_ceiling(scene.parts);
  add_windows(scene.parts);
  add_presentation(scene.parts);
  add_table(scene.parts);
  add_chairs(scene.parts);
  add_desk_things(scene.parts);
  add_drinks(scene.parts);
  add_plants(scene.parts);
  add_conference_images(scene.images);
  return scene;
}

}  // namespace kiloband::generator
