#include "support.hpp"

#include <gtest/gtest.h>

namespace kiloband::test {

std::string scene(const std::string& body) {
  return "<scene version=\"3.0.0\">\n" + body + "\n</scene>\n";
}

std::string complete_scene(const std::string& body) {
  return scene(body + "\n" + kSensor + kLight + kSphere);
}

SceneDescription read(const std::string& text, const std::filesystem::path& folder, const Defines& defines,
                      const DiagnosticSink& sink) {
  ReadOptions options;
  options.defines = defines;
  options.sink = sink;
  return read_scene_text(text, "scene.xml", folder, options);
}

std::string error_of(const std::string& text, const std::filesystem::path& folder, const Defines& defines) {
  return error_of([&] { read(text, folder, defines); });
}

std::string error_of(const std::string& text, const TemporaryFolder& folder) {
  return folder.strip(error_of(text, folder.path()));
}

Spectrum reflectance(const std::string& parameter) {
  const SceneDescription result = read(scene(R"(<shape type="sphere"><bsdf type="diffuse">)" + parameter +
                                             "</bsdf></shape>" + kSensor + kLight));
  return std::get<Spectrum>(std::get<DiffuseBsdf>(result.shapes.at(0).bsdf->model).reflectance);
}

Spectrum radiance(const std::string& parameter) {
  const SceneDescription result =
      read(scene(R"(<emitter type="constant">)" + parameter + "</emitter>" + kSensor));
  return std::get<ConstantEmitter>(result.emitters.at(0).model).radiance;
}

void expect_messages(const std::vector<BrokenScene>& scenes, const TemporaryFolder& folder) {
  for (const BrokenScene& broken : scenes) {
    EXPECT_EQ(error_of(broken.text, folder), broken.message) << broken.name;
  }
}

}  // namespace kiloband::test
