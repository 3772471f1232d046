// Scenes of the hard cases, written as text.
#pragma once

#include <initializer_list>
#include <sstream>
#include <string>

namespace kiloband::validation {

inline std::string exact_text(double x) {
  std::ostringstream out;
  out.precision(17);
  out << x;
  return out.str();
}
/// For names.
inline std::string short_text(double x) {
  std::ostringstream out;
  out << x;
  return out.str();
}
inline std::string point_text(double x, double y, double z) {
  return exact_text(x) + ", " + exact_text(y) + ", " + exact_text(z);
}
inline std::string value_element(const std::string& tag, const std::string& name, const std::string& value) {
  return "<" + tag + " name=\"" + name + "\" value=\"" + value + "\"/>";
}
inline std::string float_element(const std::string& name, double value) {
  return value_element("float", name, exact_text(value));
}
/// A spectrum that is the same at every wavelength, or "nm:value, ..." pieces.
inline std::string spectrum_element(const std::string& name, double value) {
  return value_element("spectrum", name, exact_text(value));
}
inline std::string object(const std::string& element, const std::string& type, const std::string& content) {
  return "<" + element + " type=\"" + type + "\">" + content + "</" + element + ">";
}
inline std::string bsdf_element(const std::string& type, const std::string& content = "") {
  return object("bsdf", type, content);
}
inline std::string diffuse(double reflectance) {
  return bsdf_element("diffuse", spectrum_element("reflectance", reflectance));
}
inline std::string shape_element(const std::string& type, const std::string& content) {
  return object("shape", type, content);
}
inline std::string area_element(double radiance) {
  return object("emitter", "area", spectrum_element("radiance", radiance));
}
inline std::string environment_element(double radiance) {
  return object("emitter", "constant", spectrum_element("radiance", radiance));
}
/// Every shape without an emitter of its own has this temperature.
inline std::string ambient_element(double kelvin) {
  return object("emitter", "thermal", float_element("temperature", kelvin));
}
inline std::string to_world_element(const std::string& steps) {
  return "<transform name=\"to_world\">" + steps + "</transform>";
}
inline std::string scale_step(double x, double y, double z) {
  return "<scale value=\"" + point_text(x, y, z) + "\"/>";
}
inline std::string translate_step(double x, double y, double z) {
  return "<translate value=\"" + point_text(x, y, z) + "\"/>";
}
inline std::string rotate_step(double x, double y, double z, double degrees) {
  return "<rotate value=\"" + point_text(x, y, z) + "\" angle=\"" + exact_text(degrees) + "\"/>";
}
inline std::string lookat_step(const std::string& origin, const std::string& target, const std::string& up) {
  return "<lookat origin=\"" + origin + "\" target=\"" + target + "\" up=\"" + up + "\"/>";
}
inline const std::string kInwards = "<boolean name=\"flip_normals\" value=\"true\"/>";

inline std::string film_element(uint32_t width, uint32_t height) {
  return "<film type=\"hdrfilm\">" + value_element("integer", "width", std::to_string(width)) +
         value_element("integer", "height", std::to_string(height)) + "<rfilter type=\"box\"/></film>";
}
/// Rays begin `near` metres from the camera.
inline std::string perspective_element(const std::string& steps, double fov_degrees, uint32_t size,
                                       double near) {
  return object("sensor", "perspective",
                float_element("fov", fov_degrees) + float_element("near_clip", near) +
                    float_element("far_clip", 1e9) + to_world_element(steps) + film_element(size, size));
}
/// All rays have one direction; the image is 2 `half` metres across.
inline std::string orthographic_element(const std::string& look, double half, uint32_t size, double near) {
  return object("sensor", "orthographic",
                float_element("near_clip", near) + float_element("far_clip", 1e9) +
                    to_world_element(scale_step(half, half, 1) + look) + film_element(size, size));
}
/// max_depth -1: unlimited. Roulette begins behind rr_depth vertices.
inline std::string scene_text(int max_depth, const std::string& body, int rr_depth = 5) {
  return "<scene version=\"3.0.0\">" +
         object("integrator", "path",
                value_element("integer", "max_depth", std::to_string(max_depth)) +
                    value_element("integer", "rr_depth", std::to_string(rr_depth))) +
         body + "</scene>";
}

}  // namespace kiloband::validation
