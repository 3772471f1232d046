// Checks of the files that a command is to write, before the work begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace kiloband {

struct OutputFiles {
  std::optional<std::filesystem::path> scene;  // must not be overwritten
  std::vector<std::filesystem::path> cubes;
  std::optional<std::filesystem::path> preview, stats, checkpoint;
  uint32_t kept_replicates = 0;  // cubes of replicates that are written beside each cube
};

/// Hours of rendering must not end at a file name: to be called before the scene is read. Cubes are opened by
/// their writers before the render; what is written after it is tried here. Names that a cube takes are those
/// of all its files: X.img, X.var.*, X.aux.* of an ENVI cube X.hdr, and its replicates'.
/// throws InputError   a file would be written twice or replace the scene; a name whose end is no format's
///        DeviceError  the preview or the statistics cannot be written
void check_output_files(const OutputFiles& files);

}  // namespace kiloband
