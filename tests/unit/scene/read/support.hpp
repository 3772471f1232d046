// Scenes from text for the tests of the scene reader.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scene/read/reader.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {

/// What a scene needs besides what a test is about; all on one line, so that line numbers stay simple.
inline const std::string kSensor = R"(<sensor type="perspective"/>)";
inline const std::string kLight = R"(<emitter type="constant"/>)";
inline const std::string kSphere = R"(<shape type="sphere"/>)";

/// "<scene version="3.0.0">\n" + body + "\n</scene>\n": the body begins in line 2, column 1.
std::string scene(const std::string& body);
/// The same with a sensor, an environment and a sphere in the line after the body.
std::string complete_scene(const std::string& body);

using Defines = std::vector<std::pair<std::string, std::string>>;

/// Reads text named "scene.xml" with files from `folder`.
SceneDescription read(const std::string& text, const std::filesystem::path& folder = "/nonexistent",
                      const Defines& defines = {}, const DiagnosticSink& sink = {});

/// The message of the InputError that reading throws; "accepted" if there is none.
std::string error_of(const std::string& text, const std::filesystem::path& folder = "/nonexistent",
                     const Defines& defines = {});
/// The same without the folder in front of file names.
std::string error_of(const std::string& text, const TemporaryFolder& folder);

/// The reflectance of the first shape of a complete scene whose diffuse bsdf holds `parameter`.
Spectrum reflectance(const std::string& parameter);
/// The radiance of a constant emitter that holds `parameter`.
Spectrum radiance(const std::string& parameter);

struct BrokenScene {
  std::string name;
  std::string text;
  std::string message;
};

/// Each scene gives exactly its message. folder: of the files that it names
void expect_messages(const std::vector<BrokenScene>& scenes,
                     const TemporaryFolder& folder = TemporaryFolder());

}  // namespace kiloband::test
