// kiloband convert IN OUT: formats, channel selection, coarser channels, regions and pixels as CSV.
#include <fmt/core.h>

#include <charconv>
#include <memory>

#include "app/commands.hpp"
#include "app/messages.hpp"
#include "app/render_options.hpp"
#include "film/convert.hpp"
#include "film/cube_io.hpp"
#include "film/cube_text.hpp"

namespace kiloband {
namespace {

struct ConvertOptions {
  std::string in, out;
  std::optional<std::string> select, range, rebin, crop, quantity;
  std::vector<std::string> pixels, regions;
};

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

PixelRect parse_rect(const std::string& option, const std::string& text) {
  const auto n = parse_numbers(option, text, 4);
  return {n[0], n[1], n[2], n[3]};
}

WavelengthRange parse_range(const std::string& text) {
  const ChannelList one = parse_channels_option("--range", text);
  if (one.size() != 1) throw InputError("--range " + text + ": must be one interval such as 400-500");
  return {one.front().min_nm, one.front().max_nm};
}

CubeSelection selection_of(const ConvertOptions& options, const CubeInfo& info) {
  CubeSelection selection;
  if (options.select) selection.bands = parse_band_indices(*options.select, info.bands.size());
  if (options.range) selection.range = parse_range(*options.range);
  if (options.rebin) selection.rebin = parse_channels_option("--rebin", *options.rebin);
  if (options.crop) selection.crop = parse_rect("--crop", *options.crop);
  if (options.quantity == "integral") selection.quantity = Quantity::kIntegral;
  if (options.quantity == "density") selection.quantity = Quantity::kDensity;
  return selection;
}

int convert(const ConvertOptions& options) {
  const DiagnosticSink sink = print_diagnostics(false);
  const std::filesystem::path out = options.out;
  auto cube = open_cube(options.in, sink);
  const CubeSelection selection = selection_of(options, cube->info());
  const bool table = to_lower(out.extension().string()) == ".csv";
  if (!table) {
    if (!options.pixels.empty() || !options.regions.empty()) {
      throw InputError("--pixel and --region write CSV: the output must end in .csv");
    }
    cube.reset();
    convert_cube(options.in, out, selection, sink);
    tell("wrote {}\n", out.string());
    return kDone;
  }
  std::vector<PixelRect> places;
  for (const std::string& text : options.pixels) {
    const auto n = parse_numbers("--pixel", text, 2);
    places.push_back({n[0], n[1], 1, 1});
  }
  for (const std::string& text : options.regions) places.push_back(parse_rect("--region", text));
  if (places.empty()) throw InputError("CSV output needs --pixel X,Y or --region X,Y,WIDTH,HEIGHT");
  const auto selected = select_from_cube(std::move(cube), selection, sink);
  write_csv(*selected, out, places);
  tell("wrote {}\n", out.string());
  return kDone;
}

}  // namespace

Command add_convert(CLI::App& program) {
  auto o = std::make_shared<ConvertOptions>();
  CLI::App* command = program.add_subcommand(
      "convert", "Convert a cube: EXR, ENVI, coarser channels, regions and pixels to CSV");
  command->add_option("IN", o->in, "spectral EXR or ENVI cube")->required();
  command->add_option("OUT", o->out, ".exr, .hdr (ENVI) or .csv")->required();
  command->add_option("--select", o->select, "channels by index from 0, such as 0-9,20");
  command->add_option("--range", o->range, "channels inside an interval in nm, such as 400-500");
  command->add_option("--rebin", o->rebin, "coarser channels, unions of whole ones: 400:700:10");
  command->add_option("--crop", o->crop, "X,Y,WIDTH,HEIGHT");
  command->add_option("--quantity", o->quantity, "of the values written")
      ->check(CLI::IsMember({"integral", "density"}));
  command->add_option("--pixel", o->pixels, "X,Y: the spectrum of a pixel (CSV); may be repeated")
      ->allow_extra_args(false);
  command
      ->add_option("--region", o->regions,
                   "X,Y,WIDTH,HEIGHT: the mean spectrum of a region (CSV); may be repeated")
      ->allow_extra_args(false);
  return [o] { return convert(*o); };
}

}  // namespace kiloband
