#include "room_scene.hpp"

namespace kiloband::test {
namespace {

std::string integer(const std::string& name, unsigned value) {
  return "<integer name=\"" + name + "\" value=\"" + std::to_string(value) + "\"/>";
}

std::string rectangle(const std::string& steps, const std::string& contents) {
  return "<shape type=\"rectangle\"><transform name=\"to_world\">" + steps + "</transform>" + contents +
         "</shape>";
}

std::string diffuse(const std::string& points) {
  return "<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"" + points + "\"/></bsdf>";
}

std::string walls() {
  return rectangle("<rotate x=\"1\" angle=\"-90\"/><translate y=\"-1\"/>",
                   "<bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\"><transform "
                   "name=\"to_uv\">"
                   "<scale x=\"3\" y=\"3\"/></transform></texture></bsdf>") +
         rectangle("<rotate x=\"1\" angle=\"90\"/><translate y=\"1\"/>", diffuse("500:0.7, 600:0.8")) +
         rectangle("<translate z=\"-1\"/>",
                   "<bsdf type=\"plastic\"><rgb name=\"diffuse_reflectance\" value=\"0.6, 0.3, 0.2\"/>"
                   "<boolean name=\"nonlinear\" value=\"true\"/></bsdf>") +
         rectangle("<rotate y=\"1\" angle=\"90\"/><translate x=\"-1\"/>",
                   diffuse("500:0.1, 550:0.6, 600:0.2")) +
         rectangle("<rotate y=\"1\" angle=\"-90\"/><translate x=\"1\"/>",
                   "<bsdf type=\"roughplastic\"><float name=\"alpha\" value=\"0.2\"/></bsdf>");
}

std::string objects() {
  return "<shape type=\"sphere\"><point name=\"center\" x=\"0.45\" y=\"-0.6\" z=\"0.2\"/><float "
         "name=\"radius\" value=\"0.38\"/>"
         "<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.2\"/>"
         "<spectrum name=\"eta\" value=\"500:0.9, 600:0.2\"/><spectrum name=\"k\" value=\"500:2.1, "
         "600:3\"/></bsdf></shape>"
         "<shape type=\"sphere\"><point name=\"center\" x=\"-0.45\" y=\"0.2\" z=\"0.3\"/><float "
         "name=\"radius\" value=\"0.3\"/>"
         "<bsdf type=\"dielectric\"/></shape>"
         "<shape type=\"cube\"><transform name=\"to_world\"><scale x=\"0.25\" y=\"0.4\" z=\"0.25\"/>"
         "<rotate y=\"1\" angle=\"25\"/><translate x=\"-0.4\" y=\"-0.6\" z=\"-0.2\"/></transform>"
         "<bsdf type=\"roughdielectric\"><float name=\"alpha\" value=\"0.3\"/></bsdf></shape>"
         "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"0.35\"/><translate x=\"0.4\" "
         "y=\"0.4\" z=\"0.5\"/>"
         "</transform><bsdf type=\"mask\"><float name=\"opacity\" value=\"0.6\"/>" +
         diffuse("500:0.2, 600:0.9") + "</bsdf></shape>";
}

}  // namespace

std::string scene_text(int max_depth, const std::string& parts, bool hide_emitters) {
  return "<scene version=\"3.0.0\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"" +
         std::to_string(max_depth) + "\"/><boolean name=\"hide_emitters\" value=\"" +
         (hide_emitters ? "true" : "false") + "\"/></integrator>" + parts + "</scene>";
}

std::string film_text(const FilmSize& size) {
  std::string crop;
  if (size.crop_width > 0) {
    crop = integer("crop_offset_x", size.crop_x) + integer("crop_offset_y", size.crop_y) +
           integer("crop_width", size.crop_width) + integer("crop_height", size.crop_height);
  }
  return "<film type=\"hdrfilm\">" + integer("width", size.width) + integer("height", size.height) + crop +
         "<rfilter type=\"gaussian\"/></film>";
}

std::string camera_text(const FilmSize& size) {
  return "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><transform name=\"to_world\">"
         "<lookat origin=\"0, 0, 4\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>" +
         film_text(size) + "</sensor>";
}

std::string room_parts() {
  const std::string light = rectangle(
      "<scale value=\"0.4\"/><rotate x=\"1\" angle=\"90\"/><translate y=\"0.99\"/>",
      "<emitter type=\"area\"><spectrum name=\"radiance\" value=\"500:2, 530:9, 600:4\"/></emitter>");
  return walls() + objects() + light +
         "<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"0.3\" z=\"0.9\"/><spectrum "
         "name=\"intensity\" "
         "value=\"500:0.3, 600:0.6\"/></emitter><emitter type=\"constant\"><spectrum name=\"radiance\" "
         "value=\"0.2\"/></emitter>";
}

RenderSpec room_spec(const FilmSize& size) {
  RenderSpec spec;
  spec.xml = scene_text(6, camera_text(size) + room_parts());
  spec.responses = {{"sum", Spectrum::constant(1)}};
  spec.spp = 16;
  spec.sampling.replicates = 4;
  spec.sampling.seed = 5;
  spec.threads = 1;
  return spec;
}

}  // namespace kiloband::test
