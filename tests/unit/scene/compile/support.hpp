// Scenes with spectral images for the tests of this folder.
#pragma once

#include <string>

#include "scene/compile/flat_scene.hpp"
#include "scene/read/reader.hpp"
#include "tests/support/cube_files.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {

/// A scene with a camera around `body`, whose first byte is line 1, column 25.
inline std::string scene_around(const std::string& body) {
  return "<scene version='3.0.0'>\n" + body + "<sensor type='perspective'/></scene>";
}

inline std::string sphere_with(const std::string& reflectance) {
  return "<shape type='sphere'><bsdf type='diffuse'>" + reflectance +
         "</bsdf></shape><emitter type='constant'/>";
}

/// The message of reading, without the folder's name; "accepted" if there is none.
inline std::string error_of(const std::string& body, const TemporaryFolder& folder) {
  return error_of(folder, [&] { read_scene_text(scene_around(body), "scene.xml", folder.path(), {}); });
}

/// What flattening says of a scene that consists of `body`: its first warning, or its error behind the position.
inline std::string flattened(const std::string& body) {
  const ChannelList channels = parse_channels("500-510");
  Messages warnings;
  const std::string error = error_of([&] {
    compile_scene(read_scene_text("<scene version='3.0.0'>" + body + "</scene>", "scene.xml", "."),
                  {channels, channels, warnings.sink()});
  });
  if (error != "accepted") return error.substr(error.find("error: "));
  return warnings.texts.empty() ? "" : warnings.texts.front();
}

}  // namespace kiloband::test
