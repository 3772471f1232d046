// Rooms, lights and cameras of the zoo's scenes, as text.
#pragma once

#include "tests/support/scene_text.hpp"

namespace kiloband::scene_text {

inline Text floor(const Text& material) {
  return rectangle(scale("1.1") + turn("x", "-90") + translate("0 -1.1 0"), material);
}
inline Text back(const Text& material) {
  return rectangle(scale("1.1") + translate("0 0 -1.1"), material);
}
inline Text left(const Text& material) {
  return rectangle(scale("1.1") + turn("y", "90") + translate("-1.1 0 0"), material);
}
inline Text right(const Text& material) {
  return rectangle(scale("1.1") + turn("y", "-90") + translate("1.1 0 0"), material);
}
inline Text ceiling(const Text& material) {
  return rectangle(scale("1.1") + turn("x", "90") + translate("0 1.1 0"), material);
}
/// A box, open in front. Its walls do not stand at powers of two: there, rays would leave a surface from one
/// of two points 256 units in the last place apart, as the last bit of the hit has it.
inline Text room() {
  return floor(diffuse("0.6")) + back(diffuse("450:0.7, 650:0.5")) + left(diffuse("450:0.1, 650:0.7")) +
         right(diffuse("450:0.2, 550:0.7, 650:0.1")) + ceiling(diffuse("0.7"));
}
inline Text ceiling_lamp() {
  return rectangle(scale("0.4") + turn("x", "90") + translate("0 1.08 0"),
                   diffuse("0") + lamp("450:4, 550:9, 650:6"));
}
/// 32 x 32 pixels, or a crop window of as many.
inline Text small_film(const Text& filter, const Text& its_size = size(32, 32)) {
  return film(its_size, filter);
}
inline Text view(const Text& steps = "") {
  return to_world(steps + lookat("0, 0, 4.3", "0, 0, 0"));
}
inline Text perspective(const Text& a_film) {
  return object("sensor", "perspective", real("fov", "34") + view() + a_film);
}
inline Text thinlens(const Text& a_film) {
  return object(
      "sensor", "thinlens",
      real("fov", "34") + real("aperture_radius", "0.1") + real("focus_distance", "3.8") + view() + a_film);
}
inline Text orthographic(const Text& a_film) {
  return object("sensor", "orthographic", view(scale("1.1")) + a_film);
}

}  // namespace kiloband::scene_text
