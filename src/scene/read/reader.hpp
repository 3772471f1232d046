// Reads Mitsuba 3 scene files (and version 0.x files) into a SceneDescription.
// docs/scene_format.md is the contract.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.hpp"
#include "scene/description/description.hpp"

namespace kiloband {

struct ReadOptions {
  std::vector<std::pair<std::string, std::string>> defines;  // -D name=value
  DiagnosticSink sink;
  std::function<void(const std::filesystem::path&)> reads;  // is told of every file that the scene names
  /// Width and height in pixels that replace the film's (--size); InputError if the film has a crop window.
  std::optional<std::pair<uint32_t, uint32_t>> film_size;
};

/// Reads, loads everything that the scene names (meshes, images, spectra) and checks the whole.
/// throws InputError  "file:line:column: error: ..." for the first thing that is wrong
SceneDescription read_scene(const std::filesystem::path& file, const ReadOptions& options = {});

/// The same from text; `directory` is where relative file names start,
/// `name` stands for the file in messages.
SceneDescription read_scene_text(std::string text, const std::string& name,
                                 const std::filesystem::path& directory, const ReadOptions& options = {});

}  // namespace kiloband
