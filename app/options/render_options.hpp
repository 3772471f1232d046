// What `kiloband render` and `kiloband info` are told on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/description/derived_channels.hpp"
#include "scene/read/reader.hpp"
#include "spectral/channels.hpp"

namespace kiloband {

/// Options that choose the scene and its channels; shared by the subcommands that read scenes.
struct SceneOptions {
  std::string scene;
  std::vector<std::string> defines;
  std::optional<std::string> bands, bands_file, guide_bands, size;
  std::optional<int> max_depth;
  std::string light_selection = "auto";

  void add_to(CLI::App& command);
};

/// A scene with its channels decided: command line over scene over the default 380:780:40.
struct LoadedScene {
  SceneDescription description;
  ChannelList channels, guide;
  std::vector<std::filesystem::path> files;  // that the scene names
};

/// To be called first: a cube in place of a scene would be refused for its first strange byte.
/// throws InputError  the file exists and is named like a cube or an image
void check_scene_file(const std::filesystem::path& file);

/// throws InputError for options and files
LoadedScene load_scene(const SceneOptions& options, const DiagnosticSink& sink);

/// Responses of files (--response) and of a specfilm, tabulated over the channels; a response that reaches
/// beyond the channels gives a warning with the part of its integral that is missing.
DerivedChannels load_responses(const std::vector<std::string>& files, const LoadedScene& scene,
                               const DiagnosticSink& sink);

/// "640x480" of --size.
/// throws InputError
std::pair<uint32_t, uint32_t> parse_size_option(const std::string& text);

/// The channels of an option; messages begin with its name.
/// throws InputError
ChannelList parse_channels_option(const std::string& option, const std::string& text);

/// Prints warnings and notes to standard error (notes only if not quiet).
DiagnosticSink print_diagnostics(bool quiet);

}  // namespace kiloband
