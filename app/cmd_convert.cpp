// kiloband convert IN OUT: formats, channel selection, coarser channels;
// pixels, regions and signatures as CSV.
#include <fmt/core.h>

#include <filesystem>
#include <memory>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/open_files.hpp"
#include "app/console/output_files.hpp"
#include "app/options/render_options.hpp"
#include "app/options/signature_options.hpp"
#include "cube/cube_io.hpp"
#include "cube/cube_text.hpp"
#include "post/convert.hpp"
#include "spectral/files/text_table.hpp"

namespace kiloband {
namespace {

struct ConvertOptions {
  std::string in, out;
  std::optional<std::string> wavelengths, select, range, rebin, crop, quantity;
  PlaceOptions places;
};

WavelengthRange parse_range(const std::string& text) {
  const ChannelList one = parse_channels_option("--range", text);
  if (one.size() != 1) throw InputError("--range " + text + ": must be one interval such as 400-500");
  return {one.front().min_nm, one.front().max_nm};
}

bool is_file(const std::string& value) {
  std::error_code unknown;  // a list that is longer than names can be
  return std::filesystem::is_regular_file(value, unknown);
}

/// The option's value, or what stands in the file that it names.
std::string text_or_file(const std::string& value) {
  return is_file(value) ? read_text_file(value) : value;
}

bool is_table(const ConvertOptions& options) {
  return lowered_extension(options.out) == ".csv";
}

OutputFiles output_files(const ConvertOptions& options) {
  OutputFiles files;
  options.places.add_inputs(files);
  add_cube_input(files, "the cube", options.in);
  if (options.wavelengths && is_file(*options.wavelengths))
    add_inputs(files, "--wavelengths", {*options.wavelengths});
  if (is_table(options))
    files.others.push_back({"OUT", options.out});
  else
    files.cubes.emplace_back(options.out);
  return files;
}

CubeSelection selection_of(const ConvertOptions& options, const CubeInfo& info) {
  CubeSelection selection;
  if (options.wavelengths) selection.wavelengths = parse_band_wavelengths(text_or_file(*options.wavelengths));
  if (options.select) selection.bands = parse_band_indices(*options.select, info.bands.size());
  if (options.range) selection.range = parse_range(*options.range);
  if (options.rebin) selection.rebin = parse_channels_option("--rebin", *options.rebin);
  if (options.crop) selection.crop = parse_rect("--crop", *options.crop);
  if (options.quantity == "integral") selection.quantity = Quantity::kIntegral;
  if (options.quantity == "density") selection.quantity = Quantity::kDensity;
  return selection;
}

int convert(const ConvertOptions& options) {
  allow_many_open_files();
  const DiagnosticSink sink = print_diagnostics(false);
  const std::filesystem::path out = options.out;
  const CubeInfo info = open_cube(options.in)->info();
  check_holds_radiances(options.in, info);
  CubeSelection selection = selection_of(options, info);
  check_output_files(output_files(options));
  if (!is_table(options)) {
    if (options.places.any())
      throw InputError("--pixel, --region and --signature write CSV: the output must end in .csv");
    convert_cube(options.in, out, selection, sink);
    tell("wrote {}\n", out.string());
    return kDone;
  }
  if (!options.places.any())
    throw InputError("CSV output needs --pixel X,Y, --region X,Y,WIDTH,HEIGHT or --signature");
  if (options.places.signature && !selection.quantity) selection.quantity = Quantity::kIntegral;
  const CubeChange change = [&](ReplicatedCube cube) {
    return select_from_cube(std::move(cube), selection, sink);
  };
  write_places(options.places, options.in, change, out, sink);
  tell("wrote {}\n", out.string());
  return kDone;
}

}  // namespace

Command add_convert(CLI::App& program) {
  auto o = std::make_shared<ConvertOptions>();
  CLI::App* command = program.add_subcommand(
      "convert", "Convert a cube: EXR, ENVI, coarser channels; pixels, regions and signatures to CSV");
  command->add_option("IN", o->in, "spectral EXR or ENVI cube")->required();
  command->add_option("OUT", o->out, ".exr, .hdr (ENVI) or .csv")->required();
  command->add_option(
      "--wavelengths", o->wavelengths,
      "wavelengths in nm for bands that have names only: red=600-700,green=500-600, or a file of "
      "such entries");
  command->add_option("--select", o->select, "channels by index from 0, such as 0-9,20");
  command->add_option("--range", o->range, "channels inside an interval in nm, such as 400-500");
  command->add_option("--rebin", o->rebin, "coarser channels, unions of whole ones: 400:700:10");
  command->add_option("--crop", o->crop, "X,Y,WIDTH,HEIGHT");
  command->add_option("--quantity", o->quantity, "of the values written")
      ->check(CLI::IsMember({"integral", "density"}));
  o->places.add_to(*command);
  return [o] { return convert(*o); };
}

}  // namespace kiloband
