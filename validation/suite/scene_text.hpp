// Scenes written as text: functions that return elements of scene files, for hard cases and tests.
#pragma once

#include <fmt/format.h>

#include <string>

namespace kiloband::scene_text {

using Text = std::string;

// ---- values ----

/// All digits that a double has.
inline Text exact(double x) {
  return fmt::format("{:.17g}", x);
}
inline Text point(double x, double y, double z) {
  return exact(x) + ", " + exact(y) + ", " + exact(z);
}
inline Text number(const Text& type, const Text& name, const Text& value) {
  return "<" + type + " name='" + name + "' value='" + value + "'/>";
}
inline Text real(const Text& name, const Text& value) {
  return number("float", name, value);
}
inline Text real(const Text& name, double value) {
  return real(name, exact(value));
}
inline Text integer(const Text& name, int64_t value) {
  return number("integer", name, std::to_string(value));
}
inline Text text(const Text& name, const Text& value) {
  return number("string", name, value);
}
inline Text yes(const Text& name) {
  return number("boolean", name, "true");
}
/// A number for all wavelengths, or "nm:value, ..." pieces.
inline Text spectrum(const Text& name, const Text& value) {
  return number("spectrum", name, value);
}
inline Text spectrum(const Text& name, double value) {
  return spectrum(name, exact(value));
}

// ---- transforms ----

/// A step with the attributes as written: step("translate", "y='1'").
inline Text step(const Text& name, const Text& attributes) {
  return "<" + name + " " + attributes + "/>";
}
/// One factor, or three.
inline Text scale(const Text& value) {
  return step("scale", "value='" + value + "'");
}
inline Text scale(double x, double y, double z) {
  return scale(point(x, y, z));
}
inline Text translate(const Text& xyz) {
  return step("translate", "value='" + xyz + "'");
}
inline Text translate(double x, double y, double z) {
  return translate(point(x, y, z));
}
/// About "x", "y" or "z".
inline Text turn(const Text& axis, const Text& degrees) {
  return step("rotate", axis + "='1' angle='" + degrees + "'");
}
inline Text turn(const Text& axis, double degrees) {
  return turn(axis, exact(degrees));
}
inline Text rotate(double x, double y, double z, double degrees) {
  return step("rotate", "value='" + point(x, y, z) + "' angle='" + exact(degrees) + "'");
}
inline Text lookat(const Text& origin, const Text& target, const Text& up = "0, 1, 0") {
  return step("lookat", "origin='" + origin + "' target='" + target + "' up='" + up + "'");
}
inline Text to_world(const Text& steps) {
  return "<transform name='to_world'>" + steps + "</transform>";
}

// ---- surfaces and lights ----

inline Text object(const Text& element, const Text& type, const Text& contents) {
  return "<" + element + " type='" + type + "'>" + contents + "</" + element + ">";
}
inline Text shape(const Text& type, const Text& contents) {
  return object("shape", type, contents);
}
inline const Text kInwards = yes("flip_normals");
inline Text bsdf(const Text& type, const Text& contents = "") {
  return object("bsdf", type, contents);
}
/// value  of all wavelengths, or pieces, here and below
inline Text diffuse(const auto& reflectance) {
  return bsdf("diffuse", spectrum("reflectance", reflectance));
}
inline Text emitter(const Text& type, const Text& contents) {
  return object("emitter", type, contents);
}
/// What makes a shape a lamp.
inline Text lamp(const auto& radiance) {
  return emitter("area", spectrum("radiance", radiance));
}
inline Text sky(const auto& radiance) {
  return emitter("constant", spectrum("radiance", radiance));
}
/// In a shape its temperature; in a scene that of every shape without an emitter of its own.
inline Text thermal(const auto& kelvin) {
  return emitter("thermal", real("temperature", kelvin));
}

// ---- sensors and scenes ----

inline Text size(int width, int height) {
  return integer("width", width) + integer("height", height);
}
inline Text crop(int x, int y, int width, int height) {
  return integer("crop_offset_x", x) + integer("crop_offset_y", y) + integer("crop_width", width) +
         integer("crop_height", height);
}
/// size  of the film, and its crop window
inline Text film(const Text& size, const Text& filter = "box") {
  return object("film", "hdrfilm", size + "<rfilter type='" + filter + "'/>");
}
inline Text film(int side) {
  return film(size(side, side));
}
/// The field of view goes across the width; rays begin `near` metres from the camera.
inline Text perspective(const Text& steps, double fov_degrees, const Text& a_film, double near = 1e-4,
                        double far = 1e9) {
  return object(
      "sensor", "perspective",
      real("fov", fov_degrees) + real("near_clip", near) + real("far_clip", far) + to_world(steps) + a_film);
}
/// All rays have one direction; the image is 2 `half` metres across.
inline Text orthographic(const Text& look, double half, const Text& a_film, double near = 0.01,
                         double far = 1e9) {
  return object(
      "sensor", "orthographic",
      real("near_clip", near) + real("far_clip", far) + to_world(scale(half, half, 1) + look) + a_film);
}
/// max_depth -1: unlimited. integrator: further parameters of it
inline Text scene(int max_depth, const Text& body, const Text& integrator = "") {
  return "<scene version='3.0.0'>" +
         object("integrator", "path", integer("max_depth", max_depth) + integrator) + body + "</scene>";
}

}  // namespace kiloband::scene_text
