// Rooms, lights and cameras of the zoo's scenes, as text.
#pragma once

#include "tests/support/scene_text.hpp"

namespace kiloband::test::scene_text {

inline Text floor(const Text& material) {
  return rectangle(scale("1.1") + turn("x", "-90") + move("0 -1.1 0"), material);
}
inline Text back(const Text& material) {
  return rectangle(scale("1.1") + move("0 0 -1.1"), material);
}
inline Text left(const Text& material) {
  return rectangle(scale("1.1") + turn("y", "90") + move("-1.1 0 0"), material);
}
inline Text right(const Text& material) {
  return rectangle(scale("1.1") + turn("y", "-90") + move("1.1 0 0"), material);
}
inline Text ceiling(const Text& material) {
  return rectangle(scale("1.1") + turn("x", "90") + move("0 1.1 0"), material);
}
/// A box, open in front. Its walls do not stand at powers of two: there, rays would leave a surface from one
/// of two points 256 units in the last place apart, as the last bit of the hit has it.
inline Text room() {
  return floor(diffuse("0.6")) + back(diffuse("450:0.7, 650:0.5")) + left(diffuse("450:0.1, 650:0.7")) +
         right(diffuse("450:0.2, 550:0.7, 650:0.1")) + ceiling(diffuse("0.7"));
}
inline Text ceiling_lamp() {
  return rectangle(scale("0.4") + turn("x", "90") + move("0 1.08 0"),
                   diffuse("0") + lamp("450:4, 550:9, 650:6"));
}
inline Text sky(const Text& radiance) {
  return "<emitter type='constant'>" + spectrum("radiance", radiance) + "</emitter>";
}

inline Text film(const Text& filter, const Text& size = integer("width", 32) + integer("height", 32)) {
  return "<film type='hdrfilm'>" + size + "<rfilter type='" + filter + "'/></film>";
}
inline Text view(const Text& steps = "") {
  return "<transform name='to_world'>" + steps +
         step("lookat", "origin='0, 0, 4.3' target='0, 0, 0' up='0, 1, 0'") + "</transform>";
}
inline Text perspective(const Text& a_film) {
  return "<sensor type='perspective'>" + real("fov", "34") + view() + a_film + "</sensor>";
}
inline Text thinlens(const Text& a_film) {
  return "<sensor type='thinlens'>" + real("fov", "34") + real("aperture_radius", "0.1") +
         real("focus_distance", "3.8") + view() + a_film + "</sensor>";
}
inline Text orthographic(const Text& a_film) {
  return "<sensor type='orthographic'>" + view(scale("1.1")) + a_film + "</sensor>";
}

inline Text scene(int max_depth, const Text& sensor, const Text& parts, const Text& more = "") {
  return "<scene version='3.0.0'><integrator type='path'>" + integer("max_depth", max_depth) + more +
         "</integrator>" + sensor + parts + "</scene>";
}

}  // namespace kiloband::test::scene_text
