// Pieces of scene files for the zoo's table: functions that return elements as text.
#pragma once

#include <string>

namespace kiloband::test::scene_text {

using Text = std::string;

inline Text number(const Text& type, const Text& name, const Text& value) {
  return "<" + type + " name='" + name + "' value='" + value + "'/>";
}
inline Text real(const Text& name, const Text& value) {
  return number("float", name, value);
}
inline Text integer(const Text& name, int value) {
  return number("integer", name, std::to_string(value));
}
inline Text text(const Text& name, const Text& value) {
  return number("string", name, value);
}
inline Text yes(const Text& name) {
  return number("boolean", name, "true");
}
inline Text spectrum(const Text& name, const Text& value) {
  return number("spectrum", name, value);
}

inline Text bsdf(const Text& type, const Text& contents = "") {
  return "<bsdf type='" + type + "'>" + contents + "</bsdf>";
}
inline Text diffuse(const Text& reflectance) {
  return bsdf("diffuse", spectrum("reflectance", reflectance));
}
/// A metal with n and k that depend on wavelength.
inline Text metal(const Text& type, const Text& more = "") {
  return bsdf(type, spectrum("eta", "450:1.4, 550:0.4, 650:0.2") + spectrum("k", "450:1.9, 650:3.4") + more);
}
inline Text roughness(const Text& distribution, const Text& alpha, const Text& alpha_v = "") {
  return text("distribution", distribution) +
         (alpha_v.empty() ? real("alpha", alpha) : real("alpha_u", alpha) + real("alpha_v", alpha_v));
}
inline Text bitmap(const Text& name, const Text& file, const Text& wrap, const Text& filter,
                   const Text& to_uv) {
  return "<texture type='bitmap' name='" + name + "'>" + text("filename", file) + text("wrap_mode", wrap) +
         text("filter_type", filter) + "<transform name='to_uv'>" + to_uv + "</transform></texture>";
}
/// `source` names the image: text("filename", ...), or weights and endmembers.
inline Text spectral_bitmap(const Text& name, const Text& source, const Text& wrap, const Text& filter,
                            const Text& to_uv) {
  return "<texture type='spectral_bitmap' name='" + name + "'>" + source + text("wrap_mode", wrap) +
         text("filter_type", filter) + "<transform name='to_uv'>" + to_uv + "</transform></texture>";
}
inline Text checkerboard(const Text& name, const Text& to_uv) {
  return "<texture type='checkerboard' name='" + name + "'>" + spectrum("color0", "450:0.8, 650:0.3") +
         spectrum("color1", "450:0.1, 650:0.5") + "<transform name='to_uv'>" + to_uv +
         "</transform></texture>";
}
/// A gas named `name`, which emits at a temperature in K.
inline Text gas(const Text& name, const Text& absorption, const Text& temperature = "") {
  return "<medium type='absorbing' name='" + name + "'>" + spectrum("absorption", absorption) +
         (temperature.empty() ? "" : real("temperature", temperature)) + "</medium>";
}
inline Text plume(const Text& field) {
  return "<medium type='plume' name='interior'>" + spectrum("absorption", "450:0.8, 550:3, 650:0.3") + field +
         "</medium>";
}
inline Text lamp(const Text& radiance) {
  return "<emitter type='area'>" + spectrum("radiance", radiance) + "</emitter>";
}

inline Text shape(const Text& type, const Text& steps, const Text& contents) {
  return "<shape type='" + type + "'><transform name='to_world'>" + steps + "</transform>" + contents +
         "</shape>";
}
/// A step with the attributes as written: step("translate", "y='1'").
inline Text step(const Text& name, const Text& attributes) {
  return "<" + name + " " + attributes + "/>";
}
inline Text scale(const Text& value) {
  return step("scale", "value='" + value + "'");
}
inline Text move(const Text& xyz) {
  return step("translate", "value='" + xyz + "'");
}
inline Text turn(const Text& axis, const Text& angle) {
  return step("rotate", axis + "='1' angle='" + angle + "'");
}
inline Text ball(const Text& centre, const Text& radius, const Text& contents) {
  return shape("sphere", scale(radius) + move(centre), contents);
}
inline Text rectangle(const Text& steps, const Text& contents) {
  return shape("rectangle", steps, contents);
}
inline Text mesh(const Text& file, const Text& steps, const Text& contents) {
  return shape("obj", steps, text("filename", file) + contents);
}

}  // namespace kiloband::test::scene_text
