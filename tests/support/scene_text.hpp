// More elements of scene files as text, for tests.
#pragma once

#include "validation/suite/scene_text.hpp"

namespace kiloband::scene_text {

/// A metal with n and k that depend on wavelength.
inline Text metal(const Text& type, const Text& more = "") {
  return bsdf(type, spectrum("eta", "450:1.4, 550:0.4, 650:0.2") + spectrum("k", "450:1.9, 650:3.4") + more);
}
/// Glass whose index depends on the wavelength.
inline Text dispersive(const Text& type, const Text& more = "") {
  return bsdf(type, text("int_material", "glass.txt") + more);
}
inline Text roughness(const Text& distribution, const Text& alpha, const Text& alpha_v = "") {
  return text("distribution", distribution) +
         (alpha_v.empty() ? real("alpha", alpha) : real("alpha_u", alpha) + real("alpha_v", alpha_v));
}
inline Text texture(const Text& type, const Text& name, const Text& contents, const Text& to_uv) {
  return "<texture type='" + type + "' name='" + name + "'>" + contents + "<transform name='to_uv'>" + to_uv +
         "</transform></texture>";
}
inline Text bitmap(const Text& name, const Text& file, const Text& wrap, const Text& filter,
                   const Text& to_uv) {
  return texture("bitmap", name,
                 text("filename", file) + text("wrap_mode", wrap) + text("filter_type", filter), to_uv);
}
/// `source` names the image: text("filename", ...), or weights and endmembers.
inline Text spectral_bitmap(const Text& name, const Text& source, const Text& wrap, const Text& filter,
                            const Text& to_uv) {
  return texture("spectral_bitmap", name, source + text("wrap_mode", wrap) + text("filter_type", filter),
                 to_uv);
}
inline Text checkerboard(const Text& name, const Text& to_uv) {
  return texture("checkerboard", name,
                 spectrum("color0", "450:0.8, 650:0.3") + spectrum("color1", "450:0.1, 650:0.5"), to_uv);
}
inline Text medium(const Text& type, const Text& name, const Text& contents) {
  return "<medium type='" + type + "' name='" + name + "'>" + contents + "</medium>";
}
/// A gas named `name`, which emits at a temperature in K.
inline Text gas(const Text& name, const Text& absorption, const Text& temperature = "") {
  return medium(
      "absorbing", name,
      spectrum("absorption", absorption) + (temperature.empty() ? "" : real("temperature", temperature)));
}
inline Text plume(const Text& field) {
  return medium("plume", "interior", spectrum("absorption", "450:0.8, 550:3, 650:0.3") + field);
}
inline Text shape(const Text& type, const Text& steps, const Text& contents) {
  return shape(type, to_world(steps) + contents);
}
inline Text ball(const Text& centre, const Text& radius, const Text& contents) {
  return shape("sphere", scale(radius) + translate(centre), contents);
}
inline Text rectangle(const Text& steps, const Text& contents) {
  return shape("rectangle", steps, contents);
}
inline Text mesh(const Text& file, const Text& steps, const Text& contents) {
  return shape("obj", steps, text("filename", file) + contents);
}

}  // namespace kiloband::scene_text
