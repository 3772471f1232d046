// Checks of the files that a command is to write, before the work begins.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kiloband {

/// A file and the option that names it, for messages; of inputs what it is: "the scene".
struct NamedFile {
  std::string name;
  std::filesystem::path file;
};

struct OutputFiles {
  std::vector<NamedFile> inputs;  // must not be overwritten
  std::vector<std::filesystem::path> cubes;
  std::optional<std::filesystem::path> preview, stats, checkpoint;
  std::vector<NamedFile> others;  // tables, pictures, results
  uint32_t kept_replicates = 0;   // cubes of replicates that are written beside each cube
};

/// Adds the files that a repeated option names to the inputs, as "the file of --response".
void add_inputs(OutputFiles& files, const std::string& option, const std::vector<std::string>& names);

/// Adds all files that a cube is read from, and its replicates'.
void add_cube_input(OutputFiles& files, const std::string& name, const std::filesystem::path& cube);

/// Hours of rendering must not end at a file name: to be called before the scene is read. Cubes are opened by
/// their writers before the render; what is written after it is tried here. Names that a cube takes are those
/// of all its files: X.img, X.var.*, X.aux.* of an ENVI cube X.hdr, and its replicates'. Two names are one
/// file if symbolic links lead them to one place, or if they are hard links;
/// pipes and devices may be named twice.
/// throws InputError   a file would be written twice or replace an input; a name whose end is no format's
///        DeviceError  the preview, the statistics or another file cannot be written; checkpoints are tried
///                     by those who know what is in their place
void check_output_files(const OutputFiles& files);

}  // namespace kiloband
