#include "box_scene.hpp"

#include <sstream>

namespace kiloband::test {
namespace {

std::string number(const std::string& name, unsigned value) {
  return "<integer name=\"" + name + "\" value=\"" + std::to_string(value) + "\"/>";
}

std::string diffuse(const std::string& points) {
  return "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"" + points + "\"/></bsdf>";
}

}  // namespace

std::string rectangle(const std::string& steps, const std::string& contents) {
  return "<shape type=\"rectangle\"><transform name=\"to_world\">" + steps + "</transform>" + contents +
         "</shape>";
}

std::string box_sensor(const Crop& crop) {
  return "<sensor type=\"perspective\"><float name=\"fov\" value=\"39\"/><transform name=\"to_world\">"
         "<lookat origin=\"0, 0, 3.8\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform><film "
         "type=\"hdrfilm\">" +
         number("width", crop.full) + number("height", crop.full) + number("crop_offset_x", crop.x) +
         number("crop_offset_y", crop.y) + number("crop_width", crop.width) +
         number("crop_height", crop.height) + "<rfilter type=\"box\"/></film></sensor>";
}

std::string box_walls() {
  const std::string white = diffuse("400:0.6, 480:0.75, 600:0.72, 780:0.8");
  const std::string red = diffuse("400:0.05, 560:0.06, 620:0.6, 780:0.7");
  const std::string green = diffuse("400:0.1, 480:0.15, 530:0.5, 580:0.2, 780:0.15");
  return rectangle("<rotate x=\"1\" angle=\"-90\"/><translate y=\"-1\"/>", white) +
         rectangle("<rotate x=\"1\" angle=\"90\"/><translate y=\"1\"/>", white) +
         rectangle("<translate z=\"-1\"/>", white) +
         rectangle("<rotate y=\"1\" angle=\"90\"/><translate x=\"-1\"/>", red) +
         rectangle("<rotate y=\"1\" angle=\"-90\"/><translate x=\"1\"/>", green);
}

std::string box_light(const std::string& radiance) {
  return rectangle("<scale value=\"0.4\"/><rotate x=\"1\" angle=\"90\"/><translate y=\"0.99\"/>",
                   diffuse("400:0.7, 780:0.78") +
                       "<emitter type=\"area\"><spectrum name=\"radiance\" value=\"" + radiance +
                       "\"/></emitter>");
}

std::string box_block() {
  return "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"0.3\" y=\"0.6\" z=\"0.3\"/>"
         "<rotate y=\"1\" angle=\"20\"/><translate x=\"-0.3\" y=\"-0.4\" z=\"-0.3\"/></transform>" +
         diffuse("400:0.6, 480:0.75, 780:0.8") + "</shape>";
}

std::string scene(int max_depth, const std::string& parts) {
  return "<scene version=\"3.0.0\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"" +
         std::to_string(max_depth) + "\"/></integrator>" + parts + "</scene>";
}

std::string comb(double first_nm, double last_nm, double period_nm, double low, double high) {
  std::ostringstream points;
  const int periods = static_cast<int>((last_nm - first_nm) / period_nm + 0.5);
  for (int i = 0; i <= 2 * periods; ++i) {
    points << (i > 0 ? ", " : "") << first_nm + 0.5 * period_nm * i << ":" << (i % 2 == 0 ? low : high);
  }
  return points.str();
}

}  // namespace kiloband::test
