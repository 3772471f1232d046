// kiloband info --check FOLDER: which scenes of a folder can be rendered, and what stops the others.
#pragma once

#include <filesystem>

#include "app/options/render_options.hpp"

namespace kiloband {

/// Reads and compiles every file *.xml below the folder whose root is <scene>, and prints a line for each, then how many load
/// and which errors stop the others, by the number of scenes that have them. `options`: channels, size and parameters for each
/// of them; its scene does not count.
/// Returns whether all load.
/// throws InputError  no such folder, or no scene in it
bool check_scenes(const std::filesystem::path& folder, const SceneOptions& options);

}  // namespace kiloband
