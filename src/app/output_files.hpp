// Checks of the files that a render is to write, before the work begins.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace kiloband {

struct OutputFiles {
  std::filesystem::path scene;  // must not be overwritten
  std::vector<std::filesystem::path> cubes;
  std::optional<std::filesystem::path> preview, stats;
};

/// Hours of rendering must not end at a file name: to be called before the scene is read. Cubes are opened by
/// their writers before the render; what is written after it is tried here.
/// throws InputError   a file would be written twice or replace the scene; a name whose end is no format's
///        DeviceError  the preview or the statistics cannot be written
void check_output_files(const OutputFiles& files);

}  // namespace kiloband
