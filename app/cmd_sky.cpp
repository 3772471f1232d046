// kiloband sky OUT: a clear sky from 0.38 to 20 um as a spectral environment map.
#include <fmt/core.h>

#include <memory>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/output_files.hpp"
#include "app/options/render_options.hpp"
#include "cube/cube_io.hpp"
#include "sky/sky_map.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kRowsAtOnce = 32;

struct SkyOptions {
  std::string out, size = "512x257";
  std::optional<std::string> bands, bands_file, preview;
  SkyParameters sky;
};

ChannelList bands_of(const SkyOptions& options) {
  if (options.bands && options.bands_file) throw InputError("--bands together with --bands-file");
  if (options.bands) return parse_channels_option("--bands", *options.bands);
  if (options.bands_file) return read_channels_file(*options.bands_file);
  return default_sky_bands();
}

CubeInfo cube_info(const SkyMap& map, const SkyParameters& sky) {
  CubeInfo info;
  info.width = map.width();
  info.height = map.height();
  for (const Channel& band : map.bands()) info.bands.push_back({band, false});
  info.quantity = Quantity::kDensity;
  info.metadata["sky"] = fmt::format(
      "clear sky: sun elevation {} azimuth {} degrees, aerosol {} at 500 nm, water {} cm, ozone {} atm cm, "
      "pressure {} "
      "hPa, air {} K, ground {} K, albedo {}, emissivity {}",
      sky.sun_elevation_deg, sky.sun_azimuth_deg, sky.aerosol_500nm, sky.water_cm, sky.ozone_atm_cm,
      sky.pressure_hpa, sky.air_temperature_k, sky.ground_temperature_k, sky.ground_albedo,
      sky.ground_emissivity);
  return info;
}

/// Linear RGB of some rows, appended.
void add_preview(const std::vector<std::array<float, 3>>& weights, std::span<const float> integrals,
                 std::vector<float>& rgb) {
  for (std::size_t i = 0; i < integrals.size(); i += weights.size()) {
    float sums[3] = {};
    for (std::size_t b = 0; b < weights.size(); ++b)
      for (int c = 0; c < 3; ++c) sums[c] += weights[b][c] * integrals[i + b];
    rgb.insert(rgb.end(), sums, sums + 3);
  }
}

void save_preview(const SkyOptions& options, const SkyMap& map, std::vector<float> rgb) {
  const float exposure = auto_exposure(rgb);
  for (float& value : rgb) value *= exposure;
  write_png(*options.preview, map.width(), map.height(), rgb);
  tell("wrote {}\n", *options.preview);
}

void write_map(const SkyOptions& options, const SkyMap& map) {
  const CubeInfo info = cube_info(map, options.sky);
  const auto weights = preview_weights(info.bands);
  const auto writer = create_cube_writer(options.out, info, std::min(kRowsAtOnce, map.height()));
  std::vector<float> rows, rgb;
  for (uint32_t y = 0; y < map.height(); y += kRowsAtOnce) {
    const uint32_t count = std::min(kRowsAtOnce, map.height() - y);
    rows.resize(std::size_t{count} * map.width() * map.bands().size());
    map.fill(y, count, rows);
    for (std::size_t i = 0; i < rows.size(); ++i)  // writers take integrals
      rows[i] = static_cast<float>(rows[i] * map.bands()[i % map.bands().size()].width_nm());
    writer->write_rows({y, count, rows, {}, {}});
    if (options.preview) add_preview(weights, rows, rgb);
  }
  writer->finish();
  tell("wrote {}\n", options.out);
  if (options.preview) save_preview(options, map, std::move(rgb));
}

/// Irradiances by the bands of the map, W m^-2.
void report(const SkyMap& map) {
  double direct = 0, diffuse = 0, thermal = 0;
  for (std::size_t b = 0; b < map.bands().size(); ++b) {
    const double width = map.bands()[b].width_nm();
    direct += width * map.direct_normal(b);
    diffuse += width * map.diffuse(b);
    thermal += width * map.thermal(b);
  }
  tell("in {} bands: direct normal {:.1f}, scattered {:.1f}, thermal {:.1f} W/m^2 on the horizontal plane\n",
       map.bands().size(), direct, diffuse, thermal);
}

int sky(const SkyOptions& options) {
  OutputFiles files;
  files.cubes.emplace_back(options.out);
  files.preview = options.preview;
  check_output_files(files);
  const auto [width, height] = parse_size_option(options.size);
  const ClearSky model(options.sky);
  const SkyMap map(model, bands_of(options), width, height);
  write_map(options, map);
  report(map);
  return kDone;
}

}  // namespace

Command add_sky(CLI::App& program) {
  auto o = std::make_shared<SkyOptions>();
  CLI::App* command = program.add_subcommand("sky", "Write a clear sky as a spectral environment map");
  SkyParameters& s = o->sky;
  command->add_option("OUT", o->out, ".exr or .hdr (ENVI)")->required();
  command->add_option("--elevation", s.sun_elevation_deg, "of the sun, degrees")->capture_default_str();
  command->add_option("--azimuth", s.sun_azimuth_deg, "of the sun, degrees from -Z towards +X")
      ->capture_default_str();
  command->add_option("--aerosol", s.aerosol_500nm, "optical depth of the aerosol at 500 nm")
      ->capture_default_str();
  command->add_option("--water", s.water_cm, "precipitable water, cm")->capture_default_str();
  command->add_option("--ozone", s.ozone_atm_cm, "atm cm")->capture_default_str();
  command->add_option("--pressure", s.pressure_hpa, "hPa")->capture_default_str();
  command->add_option("--air-temperature", s.air_temperature_k, "K, at the ground")->capture_default_str();
  command->add_option("--ground-temperature", s.ground_temperature_k, "K")->capture_default_str();
  command->add_option("--albedo", s.ground_albedo, "of the ground below 3 um")->capture_default_str();
  command->add_option("--emissivity", s.ground_emissivity, "of the ground above 4 um")->capture_default_str();
  command->add_option("--size", o->size, "WIDTHxHEIGHT, an odd height")->capture_default_str();
  command->add_option("--bands", o->bands, "such as 380:780:40; the default reaches from 380 nm to 20 um");
  command->add_option("--bands-file", o->bands_file, "CSV of min,max in nm");
  command->add_option("--preview", o->preview, "PNG picture");
  return [o] { return sky(*o); };
}

}  // namespace kiloband
