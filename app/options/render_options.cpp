#include "app/options/render_options.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <set>

#include "app/console/messages.hpp"
#include "app/options/whole_numbers.hpp"
#include "base/error.hpp"
#include "base/number.hpp"
#include "cube/channel_cover.hpp"
#include "cube/cube_text.hpp"
#include "post/effective_band.hpp"
#include "post/sensor_cube.hpp"
#include "spectral/files/spectrum_files.hpp"

namespace kiloband {
namespace {

constexpr const char* kDefaultBands = "380:780:40";
constexpr double kUncovered = 1e-3;  // part of a response outside the channels that is worth a warning

std::pair<std::string, std::string> parse_define(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw InputError("-D " + text + ": must be name=value");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

uint32_t parse_extent(std::string_view text, const std::string& whole) {
  const uint32_t value = whole_number<uint32_t>(text).value_or(0);
  if (value < 1 || value > 65535)
    throw InputError("--size " + whole + ": must be WIDTHxHEIGHT with both from 1 to 65535");
  return value;
}

}  // namespace

std::pair<uint32_t, uint32_t> parse_size_option(const std::string& text) {
  const auto cross = text.find('x');
  if (cross == std::string::npos)
    throw InputError("--size " + text + ": must be WIDTHxHEIGHT, for example 640x480");
  return {parse_extent(std::string_view(text).substr(0, cross), text),
          parse_extent(std::string_view(text).substr(cross + 1), text)};
}

void SceneOptions::add_to(CLI::App& command) {
  command.add_option("SCENE", scene, "Mitsuba 3 scene file (XML)")->required();
  command.add_option("-D", defines, "name=value: sets a scene parameter ($name); may be repeated")
      ->allow_extra_args(false);
  auto* bands_option =
      command.add_option("--bands", bands, "channels: first:last:count in nm, or \"400-410, 450-500\"");
  command.add_option("--bands-file", bands_file, "channels from a CSV file of min,max in nm")
      ->excludes(bands_option);
  command.add_option("--guide-bands", guide_bands,
                     "channels that sampling decisions are averaged over (default: the rendered)");
  command.add_option("--size", size, "WxH: image size in pixels");
  command.add_option("--max-depth", max_depth, "longest path (1: emission only, -1: unlimited)")
      ->transform(whole_numbers(-1, 1 << 30));
  command
      .add_option("--light-selection", light_selection,
                  "how lights are chosen: power, tree (by distance and orientation too), or auto, the tree "
                  "for many")
      ->check(CLI::IsMember({"auto", "power", "tree"}));
}

void check_scene_file(const std::filesystem::path& file) {
  static const std::set<std::string> kImages{".exr", ".hdr",  ".img", ".png",
                                             ".jpg", ".jpeg", ".tif", ".tiff"};
  std::error_code ignored;  // a file that is not there is reported as such by the reader
  if (!kImages.contains(lowered_extension(file))) return;
  if (!std::filesystem::is_regular_file(file, ignored)) return;
  throw InputError(
      file.string() +
      ": is a cube or an image, not a scene: must be a Mitsuba 3 scene file (XML); kiloband convert "
      "reads cubes");
}

/// Spectra below 100 nm and above 1 mm are no subject of this program: somebody means another unit.
void warn_of_other_units(const ChannelList& channels, const DiagnosticSink& sink) {
  constexpr double kLeastNm = 100, kMostNm = 1e6;
  const Channel range = hull(channels);
  if (range.min_nm >= kLeastNm && range.max_nm <= kMostNm) return;
  warn(sink, {},
       fmt::format(
           "channels from {:g} to {:g} nm: wavelengths are in nm, scenes are meant for 380 to 20000 nm",
           range.min_nm, range.max_nm));
}

LightSelection light_selection_of(const std::string& name) {
  if (name == "power") return LightSelection::kPower;
  return name == "tree" ? LightSelection::kTree : LightSelection::kAutomatic;
}

LoadedScene load_scene(const SceneOptions& options, const DiagnosticSink& sink) {
  ReadOptions read;
  std::set<std::string> defined;
  for (const std::string& define : options.defines) {
    read.defines.push_back(parse_define(define));
    if (!defined.insert(read.defines.back().first).second)
      throw InputError("-D " + define + ": the parameter is given twice");
  }
  read.sink = sink;
  if (options.size) read.film_size = parse_size_option(*options.size);
  LoadedScene loaded;
  read.reads = [&](const std::filesystem::path& file) { loaded.files.push_back(file); };
  loaded.description = read_scene(options.scene, read);
  if (options.max_depth) loaded.description.integrator.max_depth = *options.max_depth;
  loaded.description.integrator.light_selection = light_selection_of(options.light_selection);
  Film& film = loaded.description.sensor.film;
  if (options.bands || options.bands_file) {
    loaded.channels = options.bands ? parse_channels_option("--bands", *options.bands)
                                    : read_channels_file(*options.bands_file);
    film.responses.clear();  // the command line beats the scene
  } else {
    loaded.channels = film.channels.empty() ? parse_channels(kDefaultBands) : film.channels;
  }
  warn_of_other_units(loaded.channels, sink);
  loaded.guide =
      options.guide_bands ? parse_channels_option("--guide-bands", *options.guide_bands) : loaded.channels;
  return loaded;
}

DerivedChannels load_responses(const std::vector<std::string>& files, const LoadedScene& scene,
                               const DiagnosticSink& sink) {
  std::vector<std::pair<std::string, Spectrum>> responses = scene.description.sensor.film.responses;
  for (const std::string& file : files) {
    for (auto& response : read_response_file(file, sink)) responses.push_back(std::move(response));
  }
  DerivedChannels derived;
  std::set<std::string> names;
  const Channel range = hull(scene.channels);
  const ChannelCover cover(scene.channels);
  for (const auto& [name, response] : responses) {
    if (!names.insert(name).second) throw InputError("response '" + name + "' is given twice");
    const double missing = uncovered_part(response, cover);
    const bool is_dark = response.max_over(range.min_nm, range.max_nm) == 0 &&
                         response.min_over(range.min_nm, range.max_nm) == 0;
    if (missing >= 1 || is_dark) throw InputError("response '" + name + "': is 0 in all channels");
    if (missing > kUncovered) {
      warn(sink, {},
           fmt::format("response '{}': {:.3g} % of its integral lies outside the channels", name,
                       100 * missing));
    }
    derived.names.push_back(name);
    derived.responses.push_back(resample(response, range.min_nm, range.max_nm));
    derived.bands.push_back(effective_band(response, cover));
    derived.bands.back().name = name;
  }
  return derived;
}

ChannelList parse_channels_option(const std::string& option, const std::string& text) {
  static constexpr std::string_view kSubject = "bands";  // what parse_channels() calls its text
  try {
    return parse_channels(text);
  } catch (const InputError& error) {
    const std::string_view message = error.what();
    if (!message.starts_with(kSubject)) throw;
    throw InputError(option + std::string(message.substr(kSubject.size())));
  }
}

DiagnosticSink print_diagnostics(bool quiet) {
  return [quiet](const Diagnostic& diagnostic) {
    if (quiet && diagnostic.severity == Severity::kNote) return;
    tell("{}\n", diagnostic.to_string());
  };
}

}  // namespace kiloband
