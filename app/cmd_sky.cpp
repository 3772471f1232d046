// kiloband sky OUT: a clear sky from 0.38 to 20 um as a spectral environment map.
#include <fmt/core.h>

#include <fstream>
#include <map>
#include <memory>

#include "app/commands.hpp"
#include "app/console/messages.hpp"
#include "app/console/output_files.hpp"
#include "app/options/render_options.hpp"
#include "base/utf8.hpp"
#include "cube/cube_io.hpp"
#include "files/atomic_file.hpp"
#include "sky/sky_map.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kRowsAtOnce = 32;
constexpr std::string_view kSunComment = "<!-- The sun of ";

struct SkyOptions {
  std::string out, size = "512x257";
  std::optional<std::string> bands, bands_file, preview, sun;
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

/// The direct light at the middles of the map's bands, linear between them as the map is, up to its outer edges.
std::string sun_spectrum(const SkyMap& map) {
  std::map<double, double> knots;
  const auto add = [&](double nm, std::size_t band) { knots.emplace(nm, map.direct_normal(band)); };
  std::size_t first = 0, last = 0;
  for (std::size_t b = 0; b < map.bands().size(); ++b) {
    add(map.bands()[b].centre_nm(), b);
    if (map.bands()[b].min_nm < map.bands()[first].min_nm) first = b;
    if (map.bands()[b].max_nm > map.bands()[last].max_nm) last = b;
  }
  add(map.bands()[first].min_nm, first);
  add(map.bands()[last].max_nm, last);
  std::string text;
  for (const auto& [nm, value] : knots)
    text += fmt::format("{}{:.9g}:{:.7g}", text.empty() ? "" : ", ", nm, value);
  return text;
}

/// A file's name as a comment of XML may have it: no "--", no bytes that are not UTF-8.
std::string in_comment(const std::string& name) {
  const bool utf8 = is_utf8(name);
  std::string text;
  for (const char c : name) {
    if (c == '-' && text.ends_with('-')) text += ' ';
    const auto byte = static_cast<unsigned char>(c);
    text += byte < 0x20 || byte == 0x7f || (byte > 0x7f && !utf8) ? '?' : c;
  }
  return text;
}

/// A scene to be included: the map's sun as an emitter of its own.
void write_sun(const SkyOptions& options, const SkyMap& map) {
  const std::string scene = fmt::format(
      R"(<?xml version="1.0" encoding="utf-8"?>
{}{}, which is without it: include this file where the map is used.
     A map that is turned by its to_world has its sun turned by the same steps at the end of this one. -->
<scene version="3.0.0">
  <emitter type="directional">
    <float name="angular_radius" value="{}"/>
    <transform name="to_world">
      <rotate x="1" angle="{}"/>
      <rotate y="1" angle="{}"/>
    </transform>
    <spectrum name="irradiance" value="{}"/>
  </emitter>
</scene>
)",
      kSunComment, in_comment(std::filesystem::path(options.out).filename().string()), kSunRadiusDeg,
      options.sky.sun_elevation_deg, -options.sky.sun_azimuth_deg, sun_spectrum(map));
  write_file_atomically(*options.sun, scene);
  tell("wrote {}\n", *options.sun);
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
  tell("in {} bands, W/m^2: direct normal {:.1f}; on the horizontal plane scattered {:.1f}, thermal {:.1f}\n",
       map.bands().size(), direct, diffuse, thermal);
}

/// The option names an output: a scene of the user's in its place is a mistake.
void check_sun_file(const std::string& sun) {
  if (!std::filesystem::is_regular_file(sun)) return;
  std::ifstream file(sun);
  std::string first, second;
  std::getline(std::getline(file, first), second);
  if (!first.empty() && !second.starts_with(kSunComment))
    throw InputError(fmt::format(
        "--sun {}: would replace a file that kiloband sky has not written: remove it, or choose another name",
        sun));
}

int sky(const SkyOptions& options) {
  OutputFiles files;
  if (options.bands_file) add_inputs(files, "--bands-file", {*options.bands_file});
  files.cubes.emplace_back(options.out);
  files.preview = options.preview;
  if (options.sun) files.others.push_back({"--sun", *options.sun});
  check_output_files(files);
  if (options.sun) check_sun_file(*options.sun);
  if (options.sun && !(options.sky.sun_elevation_deg > 0))
    throw InputError(fmt::format("--sun with --elevation {}: the sun is not above the horizon",
                                 options.sky.sun_elevation_deg));
  const auto [width, height] = parse_size_option(options.size);
  const ClearSky model(options.sky);
  const SkyMap map(model, bands_of(options), width, height, !options.sun);
  write_map(options, map);
  if (options.sun) write_sun(options, map);
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
  command->add_option("--sun", o->sun, "scene file for the sun, which is then not in the map");
  command->add_option("--preview", o->preview, "PNG picture");
  return [o] { return sky(*o); };
}

}  // namespace kiloband
