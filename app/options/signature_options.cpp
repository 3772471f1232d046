#include "app/options/signature_options.hpp"

#include <fmt/core.h>

#include <charconv>

#include "app/options/whole_numbers.hpp"
#include "app/signature_masks.hpp"
#include "post/convert.hpp"

namespace kiloband {
namespace {

/// Comma-separated whole numbers.
std::vector<uint32_t> parse_numbers(const std::string& option, const std::string& text, std::size_t count) {
  std::vector<uint32_t> numbers;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  while (at <= end) {
    uint32_t value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || (next != end && *next != ',')) break;
    numbers.push_back(value);
    if (next == end) break;
    at = next + 1;
  }
  if (numbers.size() != count || at > end) {
    throw InputError(fmt::format("{} {}: must be {} whole numbers separated by commas", option, text, count));
  }
  return numbers;
}

std::vector<PixelRect> places_of(const PlaceOptions& options) {
  std::vector<PixelRect> places;
  for (const std::string& text : options.pixels) {
    const auto n = parse_numbers("--pixel", text, 2);
    places.push_back({n[0], n[1], 1, 1});
  }
  for (const std::string& text : options.regions) places.push_back(parse_rect("--region", text));
  return places;
}

/// Says where error bars are missing, and why.
void report_errors(const ReplicatedCube& cube, const ReplicatedCube* background,
                   const std::vector<Signature>& signatures, const DiagnosticSink& sink) {
  if (!cube.has_errors()) {
    note(sink, {},
         "no error bars: the errors of pixels are correlated and must not be pooled; render with "
         "--keep-replicates to get them");
    return;
  }
  std::size_t fewest = cube.replicates.size();
  for (const Signature& signature : signatures) fewest = std::min(fewest, signature.replicates);
  if (fewest < 2)
    note(
        sink, {},
        fmt::format(
            "no error bars, of some masks at least: {} of {} replicates have all their pixels, two are needed",
            fewest, cube.replicates.size()));
  else
    note(sink, {}, fmt::format("standard errors have {} degrees of freedom", fewest - 1));
  if (background && background->replicates.size() != cube.replicates.size())
    note(sink, {},
         fmt::format("no error bars of contrasts: the background has {} replicates, the cube {}",
                     background->replicates.size(), cube.replicates.size()));
}

void write_signature_table(const PlaceOptions& options, ReplicatedCube cube, const CubeChange& change,
                           const std::filesystem::path& file, const std::filesystem::path& out,
                           const DiagnosticSink& sink) {
  if (!options.pixels.empty()) throw InputError("--pixel: a signature has --object, --region and --mask");
  const auto camera = camera_of_cube(cube.mean->info(), file.string());
  if (!camera)
    throw InputError(file.string() +
                     ": does not state its camera: signatures need a cube that kiloband rendered");
  const std::vector<SignatureMask> masks = signature_masks(options, *cube.mean, *camera, sink);
  std::optional<ReplicatedCube> background;
  if (options.background) {
    background = change(open_replicated_cube(*options.background, sink));
    check_holds_radiances(*options.background, background->mean->info());
  }
  ReplicatedCube* behind = background ? &*background : nullptr;
  const std::vector<Signature> signatures = measure_signatures(cube, behind, masks, *camera);
  report_errors(cube, behind, signatures, sink);
  write_signatures(cube.mean->info(), signatures, cube.has_errors(), out);
}

}  // namespace

PixelRect parse_rect(const std::string& option, const std::string& text) {
  const auto n = parse_numbers(option, text, 4);
  return {n[0], n[1], n[2], n[3]};
}

void PlaceOptions::add_to(CLI::App& command) {
  command.add_option("--pixel", pixels, "X,Y: the spectrum of a pixel (CSV); may be repeated")
      ->allow_extra_args(false);
  command
      .add_option("--region", regions,
                  "X,Y,WIDTH,HEIGHT: the mean spectrum of a region (CSV); may be repeated")
      ->allow_extra_args(false);
  auto* flag = command.add_flag("--signature", signature,
                                "radiant intensity and contrast of objects, regions, masks (CSV)");
  const auto add = [&](const char* name, auto& target, const char* help) {
    return command.add_option(name, target, help)->needs(flag);
  };
  add("--object", objects, "numbers or names of objects, of the auxiliary image 'object'; may be repeated")
      ->allow_extra_args(false);
  add("--mask", masks, "image whose pixels above 0.5 are meant; may be repeated")->allow_extra_args(false);
  add("--grow", grow, "take in this many pixels around each mask")->transform(whole_numbers(0, 65535));
  auto* cube = add("--background", background, "cube rendered without the objects");
  auto* ring = add("--background-ring", background_ring, "background: this many pixels around each mask")
                   ->transform(whole_numbers(1, 65535))
                   ->excludes(cube);
  add("--background-region", background_region, "X,Y,WIDTH,HEIGHT: background")
      ->excludes(cube)
      ->excludes(ring);
  add("--distance", distance_m,
      "distance of the object in metres (default: from the auxiliary image 'depth')");
}

void PlaceOptions::add_inputs(OutputFiles& files) const {
  for (const std::string& mask : masks) add_cube_input(files, "the file of --mask", mask);
  if (background) add_cube_input(files, "the file of --background", *background);
}

void write_places(const PlaceOptions& options, const std::filesystem::path& file, const CubeChange& change,
                  const std::filesystem::path& out, const DiagnosticSink& sink) {
  ReplicatedCube cube = change(open_replicated_cube(file, sink));
  if (options.signature) return write_signature_table(options, std::move(cube), change, file, out, sink);
  write_csv(cube, out, places_of(options), sink);
}

}  // namespace kiloband
