// kiloband sensor CUBE --response F: sensor channels, XYZ, pictures and tables of a rendered cube.
#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/open_files.hpp"
#include "app/console/output_files.hpp"
#include "app/options/render_options.hpp"
#include "app/options/signature_options.hpp"
#include "cube/cube_text.hpp"
#include "post/convert.hpp"
#include "post/picture.hpp"
#include "post/sensor_cube.hpp"
#include "spectral/files/spectrum_files.hpp"

namespace kiloband {
namespace {

struct SensorOptions {
  std::string cube;
  std::vector<std::string> responses, outputs;
  PlaceOptions places;
  std::optional<std::string> png, picture;
  std::optional<double> exposure;
};

std::vector<NamedResponse> load_responses(const std::vector<std::string>& names, const DiagnosticSink& sink) {
  std::vector<NamedResponse> responses;
  for (const std::string& name : names) {
    std::error_code unknown;
    const bool built_in = lowered(name) == "xyz" && !std::filesystem::exists(name, unknown);
    for (auto& response : built_in ? xyz_responses() : read_response_file(name, sink))
      responses.push_back(std::move(response));
  }
  return responses;
}

bool is_table(const std::string& file) {
  return lowered_extension(file) == ".csv";
}

void check_options(const SensorOptions& o) {
  if (o.outputs.empty() && !o.png) throw InputError("nothing to write: give -o or --png");
  if (o.responses.empty() && !o.outputs.empty()) throw InputError("-o needs --response");
  if (o.responses.empty() && o.picture == "sensor") throw InputError("--picture sensor needs --response");
  if (o.exposure && !(*o.exposure > 0 && std::isfinite(*o.exposure)))
    throw InputError(fmt::format("--exposure {}: must be a number > 0", *o.exposure));
  if (o.exposure && *o.exposure > 1e30)
    throw InputError(fmt::format("--exposure {}: must be <= 1e+30", *o.exposure));
  bool table = false;
  for (const std::string& out : o.outputs) {
    table = table || is_table(out);
    if (!is_table(out)) check_cube_name(out);
  }
  if (table && !o.places.any())
    throw InputError("CSV output needs --pixel X,Y, --region X,Y,WIDTH,HEIGHT or --signature");
  if (!table && o.places.any())
    throw InputError("--pixel, --region and --signature write CSV: an output must end in .csv");
  if (o.png && lowered_extension(*o.png) != ".png")
    throw InputError(fmt::format("--png {}: must end in .png", *o.png));
}

PictureColours colours_of(const SensorOptions& o, const CubeInfo& info) {
  if (o.picture == "natural") return PictureColours::kNatural;
  if (o.picture == "false") return PictureColours::kFalse;
  if (o.picture == "sensor" || !o.responses.empty()) return PictureColours::kSensor;
  return shows_visible_light(info.bands) ? PictureColours::kNatural : PictureColours::kFalse;
}

void write_picture(const SensorOptions& o, const std::vector<NamedResponse>& responses) {
  auto cube = open_cube(o.cube);
  const PictureColours colours = colours_of(o, cube->info());
  if (colours == PictureColours::kSensor) cube = apply_responses(std::move(cube), responses);
  std::vector<float> rgb = make_picture(*cube, colours);
  const auto scale = o.exposure ? static_cast<float>(*o.exposure) : auto_exposure(rgb);
  for (float& value : rgb) value *= scale;
  write_png(*o.png, cube->info().width, cube->info().height, rgb);
}

OutputFiles output_files(const SensorOptions& o) {
  OutputFiles files;
  o.places.add_inputs(files);
  add_cube_input(files, "the cube", o.cube);
  add_inputs(files, "--response", o.responses);
  for (const std::string& out : o.outputs) {
    if (is_table(out))
      files.others.push_back({"-o", out});
    else
      files.cubes.emplace_back(out);
  }
  if (o.png) files.others.push_back({"--png", *o.png});
  return files;
}

int sensor(const SensorOptions& o) {
  allow_many_open_files();
  const DiagnosticSink sink = print_diagnostics(false);
  check_options(o);
  check_output_files(output_files(o));
  check_holds_radiances(o.cube, open_cube(o.cube)->info());
  const std::vector<NamedResponse> responses = load_responses(o.responses, sink);
  std::unique_ptr<CubeReader> told = open_cube(o.cube, sink);           // says what is to be said of it, once
  if (!responses.empty()) apply_responses(std::move(told), responses);  // errors before warnings
  report_responses(*open_cube(o.cube), responses, sink);
  const CubeChange change = [&](ReplicatedCube cube) {
    return std::move(cube).transformed(
        [&](std::unique_ptr<CubeReader> one) { return apply_responses(std::move(one), responses); });
  };
  for (const std::string& out : o.outputs) {
    if (is_table(out)) {
      write_places(o.places, o.cube, change, out, sink);
    } else {
      write_cube(*with_replicate_variance(change(open_replicated_cube(o.cube))), out, Quantity::kIntegral,
                 sink);
    }
    tell("wrote {}\n", out);
  }
  if (o.png) {
    write_picture(o, responses);
    tell("wrote {}\n", *o.png);
  }
  return kDone;
}

}  // namespace

Command add_sensor(CLI::App& program) {
  auto o = std::make_shared<SensorOptions>();
  CLI::App* command = program.add_subcommand(
      "sensor", "See a cube through sensor responses: bands, XYZ, pictures, tables, signatures");
  command->add_option("CUBE", o->cube, "spectral EXR or ENVI cube")->required();
  command
      ->add_option("--response", o->responses,
                   "file of responses, or xyz (CIE 1931, in cd/m^2); may be repeated")
      ->allow_extra_args(false);
  command->add_option("-o", o->outputs, "output: .exr, .hdr (ENVI) or .csv; may be repeated")
      ->allow_extra_args(false);
  o->places.add_to(*command);
  auto* png = command->add_option("--png", o->png, "picture, 8-bit sRGB");
  command
      ->add_option("--picture", o->picture,
                   "what it shows: natural colours, false colours (long waves red), or the first three "
                   "responses (default with --response)")
      ->check(CLI::IsMember({"natural", "false", "sensor"}))
      ->needs(png);
  command->add_option("--exposure", o->exposure, "factor on linear values (default: automatic)")->needs(png);
  return [o] { return sensor(*o); };
}

}  // namespace kiloband
