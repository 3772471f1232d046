// Scenes with spectral images for the tests of this folder.
#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "scene/reader.hpp"
#include "tests/support/cube_files.hpp"

namespace kiloband::test {

/// A folder that vanishes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("kiloband_scene_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  void write(const std::string& name, const std::string& contents) const {
    std::ofstream(path_ / name, std::ios::binary) << contents;
  }

 private:
  std::filesystem::path path_;
};

/// A scene with a camera around `body`, whose first byte is line 1, column 25.
inline std::string scene_around(const std::string& body) {
  return "<scene version='3.0.0'>\n" + body + "<sensor type='perspective'/></scene>";
}

inline std::string sphere_with(const std::string& reflectance) {
  return "<shape type='sphere'><bsdf type='diffuse'>" + reflectance +
         "</bsdf></shape><emitter type='constant'/>";
}

/// The message of reading, without the folder's name; "accepted" if there is none.
inline std::string error_of(const std::string& body, const TemporaryFolder& folder,
                            std::vector<std::string>* diagnostics = nullptr) {
  try {
    ReadOptions options;
    options.sink = [&](const Diagnostic& d) {
      if (diagnostics) diagnostics->push_back(d.to_string());
    };
    read_scene_text(scene_around(body), "scene.xml", folder.path(), options);
  } catch (const InputError& error) {
    std::string message = error.what();
    const std::string prefix = folder.path().string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }
  return "accepted";
}

}  // namespace kiloband::test
