#include "scene/read/sunsky.hpp"

// Mitsuba's parameters of a sunsky, our clear sky (docs/sky_model.md) as an environment and its sun as a
// directional light with an angular radius.
//
// Local up is +Z, +X is south and +Y west, as in Mitsuba 3; in old files, which have `sun` and `sky`, too, up is +Y.
// Below the horizon there is nothing.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/xml/values.hpp"
#include "sky/sky_map.hpp"
#include "sky/sun_position.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kWidth = 256, kHeight = 129;
constexpr const char* kTimeParameters[] = {"latitude", "longitude", "timezone", "year",  "month",
                                           "day",      "hour",      "minute",   "second"};

/// Optical depth of the aerosol at 500 nm: Angstrom's beta (wavelength in um)^-1.3 with beta = 0.04608 T - 0.04586.
/// Source: A. Preetham, P. Shirley, B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999, appendix 1.
double aerosol_of(double turbidity) {
  return std::max(0.0, 0.04608 * turbidity - 0.04586) * std::pow(0.5, -1.3);
}

double read_in(const ObjectReader& object, std::string_view name, double fallback, double min, double max,
               const char* rule) {
  const double value = object.get_float(name, fallback);
  object.check(value >= min && value <= max, name, value, rule);
  return value;
}

int read_whole(const ObjectReader& object, std::string_view name, int fallback, int min, int max,
               const char* rule) {
  const int64_t value = object.get_int(name, fallback);
  object.check(value >= min && value <= max, name, static_cast<double>(value), rule);
  return static_cast<int>(value);
}

PlaceAndTime read_place_and_time(const ObjectReader& object) {
  PlaceAndTime at;
  at.latitude_deg = read_in(object, "latitude", 35.6894, -90, 90, "must be from -90 to 90 degrees");
  at.longitude_deg = read_in(object, "longitude", 139.6917, -180, 180, "must be from -180 to 180 degrees");
  at.timezone_h = read_in(object, "timezone", 9, -12, 14, "must be from -12 to 14 h");
  at.year = read_whole(object, "year", 2010, 1900, 2100, "must be from 1900 to 2100");
  at.month = read_whole(object, "month", 7, 1, 12, "must be from 1 to 12");
  at.day = read_whole(object, "day", 10, 1, 31, "must be from 1 to 31");
  at.hour = read_in(object, "hour", 15, 0, 24, "must be from 0 to 24");
  at.minute = read_in(object, "minute", 0, 0, 60, "must be from 0 to 60");
  at.second = read_in(object, "second", 0, 0, 60, "must be from 0 to 60");
  const auto day = std::chrono::year(at.year) / at.month / at.day;
  if (!day.ok()) object.fail_at("day", "day: the month has no such day");
  return at;
}

/// In files of Mitsuba 0.x up is +Y. Local there to local here.
Transform up_to_y() {
  return glm::rotate(glm::dmat4(1), -90 * kDegree, glm::dvec3(1, 0, 0));
}

/// Of the sky.
Transform local_to_world(const ObjectReader& object) {
  return rotation_and_position(object) * (object.node().legacy ? up_to_y() : Transform(1.0));
}

/// Unit vector to the sun, local; sun_direction stands in the world. Of old files +X is east and +Z south.
glm::dvec3 read_direction(const ObjectReader& object) {
  if (object.has("sun_direction")) {
    for (const char* name : kTimeParameters)
      if (object.has(name)) object.fail_at(name, "'" + std::string(name) + "' together with 'sun_direction'");
    const glm::dvec3 direction = object.get_vector("sun_direction", {0, 0, 1});
    const double length = glm::length(direction);
    if (!(length > 0)) object.fail_at("sun_direction", "sun_direction: its length must be > 0");
    return glm::normalize(glm::inverse(glm::dmat3(local_to_world(object))) * direction);
  }
  const SunPosition sun = sun_position(read_place_and_time(object));
  const double elevation = sun.elevation_deg * kDegree, azimuth = sun.azimuth_deg * kDegree;
  if (object.node().legacy)
    return glm::inverse(glm::dmat3(up_to_y())) * glm::dvec3(std::sin(azimuth) * std::cos(elevation),
                                                            std::sin(elevation),
                                                            -std::cos(azimuth) * std::cos(elevation));
  return {-std::cos(azimuth) * std::cos(elevation), -std::sin(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

/// Of the visible: our model has one number.
double read_albedo(ReadContext& context, const ObjectReader& object) {
  const Spectrum albedo =
      read_spectrum(context, object, "albedo", SpectrumUse::kReflectance, Spectrum::constant(0.3));
  double sum = 0;
  constexpr int kCount = 31;
  for (int i = 0; i < kCount; ++i) sum += albedo(400 + 10 * i);
  return sum / kCount;
}

/// The map without its sun and the ground.
std::shared_ptr<const SpectralImage> make_image(const SkyMap& map) {
  const std::size_t row = std::size_t{map.width()} * map.bands().size();
  auto values = std::make_shared<std::vector<float>>(row * map.height());
  map.fill(0, map.height() / 2 + 1, std::span(*values).first(row * (map.height() / 2 + 1)));
  return std::make_shared<SpectralImage>(SpectralImage{"sunsky", map.width(), map.height(),
                                                       static_cast<uint32_t>(map.bands().size()), map.bands(),
                                                       std::move(values)});
}

/// At the middles of the bands, as the map has it, up to its outer edges.
Spectrum sun_irradiance(const SkyMap& map, double scale) {
  const ChannelList& bands = map.bands();  // in ascending order
  std::vector<double> lambda_nm{bands.front().min_nm}, values{scale * map.direct_normal(0)};
  for (std::size_t b = 0; b < bands.size(); ++b) {
    lambda_nm.push_back(bands[b].centre_nm());
    values.push_back(scale * map.direct_normal(b));
  }
  lambda_nm.push_back(bands.back().max_nm);
  values.push_back(values.back());
  return Spectrum::tabulated(std::move(lambda_nm), std::move(values));
}

struct Scales {
  double sky, sun;
};

/// Of `sun` and `sky` of old files there is one, `scale`.
Scales read_scales(const ObjectReader& object) {
  const auto read = [&](const char* name) {
    return read_in(object, name, 1, 0, 1e6, "must be from 0 to 1e+06");
  };
  if (object.type() == "sky") return {read("scale"), 0};
  if (object.type() == "sun") return {0, read("scale")};
  const Scales scales{read("sky_scale"), read("sun_scale")};
  if (scales.sky == 0 && scales.sun == 0)
    object.fail_here("sky_scale and sun_scale are both 0: there is no light");
  return scales;
}

/// Full angle, degrees.
double read_aperture(ReadContext& context, const ObjectReader& object) {
  constexpr double kSun = 0.5358;
  if (!object.node().legacy)
    return read_in(object, "sun_aperture", kSun, 0.01, 90, "must be from 0.01 to 90 degrees");
  accept_obsolete(context, object, {"resolution", "stretch", "extend"});
  return kSun * read_in(object, "sun_radius_scale", 1, 0.02, 150, "must be from 0.02 to 150");
}

void note_differences(ReadContext& context, const ObjectReader& object) {
  if (object.get_bool("complex_sun", false))
    note(context.sink, object.value_place("complex_sun").position(),
         object.label() + ": complex_sun: the sun's disc is even here");
  note(context.sink, object.node().place.position(),
       object.label() + ": the sky is kiloband's own model, see docs/sky_model.md");
}

}  // namespace

std::vector<Emitter> read_sunsky(ReadContext& context, const ObjectReader& object) {
  const double turbidity = read_in(object, "turbidity", 3, 1, 10, "must be from 1 to 10");
  const glm::dvec3 sun = read_direction(object);
  if (!(sun.z > 0)) object.fail_here("the sun is not above the horizon");
  const double aperture = read_aperture(context, object);
  const Scales scales = read_scales(object);
  SkyParameters parameters;
  parameters.sun_elevation_deg = std::asin(std::min(sun.z, 1.0)) / kDegree;
  parameters.sun_azimuth_deg = std::atan2(sun.x, sun.y) / kDegree;  // of the map that is turned to +Z
  parameters.aerosol_500nm = aerosol_of(turbidity);
  parameters.ground_albedo = read_albedo(context, object);
  const Transform to_world = local_to_world(object);
  note_differences(context, object);

  const ClearSky sky(parameters);
  const SkyMap map(sky, default_sky_bands(), kWidth, kHeight, false);
  const Node& node = object.node();
  std::vector<Emitter> emitters;
  if (scales.sky > 0) {
    const Transform up = glm::rotate(glm::dmat4(1), 90 * kDegree, glm::dvec3(1, 0, 0));
    emitters.push_back(
        {node.id, node.place.position(), SpectralEnvmapEmitter{make_image(map), scales.sky, to_world * up}});
  }
  if (scales.sun > 0) {
    const glm::dvec3 towards = glm::normalize(glm::dmat3(to_world) * sun);
    emitters.push_back(
        {node.id, node.place.position(),
         DirectionalEmitter{sun_irradiance(map, scales.sun), -towards, 0.5 * aperture * kDegree}});
  }
  return emitters;
}

}  // namespace kiloband
