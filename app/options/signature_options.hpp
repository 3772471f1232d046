// The options of `convert` and `sensor` that choose places of a cube: pixels, regions,
// and the masks of signatures.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/console/output_files.hpp"
#include "post/signature.hpp"

namespace kiloband {

/// "X,Y,WIDTH,HEIGHT"; throws InputError naming the option
PixelRect parse_rect(const std::string& option, const std::string& text);

struct PlaceOptions {
  std::vector<std::string> pixels, regions;
  bool signature = false;
  std::vector<std::string> objects, masks;
  uint32_t grow = 0;
  std::optional<std::string> background, background_region;
  std::optional<uint32_t> background_ring;
  std::optional<double> distance_m;

  void add_to(CLI::App& command);
  bool any() const { return signature || !pixels.empty() || !regions.empty(); }
  /// Adds the files that the options read.
  void add_inputs(OutputFiles& files) const;
};

/// Changes a cube as the command does before anything is measured.
using CubeChange = std::function<ReplicatedCube(ReplicatedCube)>;

/// Writes the table that the options ask for: means of pixels and regions, or signatures.
/// file    the cube, opened here with its replicates
/// change  applied to it and to the background
/// throws InputError  no place; masks that are empty, without distance ...
void write_places(const PlaceOptions& options, const std::filesystem::path& file, const CubeChange& change,
                  const std::filesystem::path& out, const DiagnosticSink& sink);

}  // namespace kiloband
