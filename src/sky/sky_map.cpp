#include "sky/sky_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.hpp"
#include "base/text.hpp"
#include "spectral/planck.hpp"

namespace kiloband {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSunPoints = 1000;
constexpr int kRowSteps = 400;

/// Phase functions, 1/sr.
double rayleigh_phase(double cosine) {
  return 3 / (16 * kPi) * (1 + cosine * cosine);
}
double aerosol_phase(double cosine) {
  constexpr double g = kAerosolAsymmetry;
  return (1 - g * g) / (4 * kPi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

/// Midpoints of a band for the integration of Planck's law and of absorption bands.
template <class F>
double band_mean(const Channel& band, const F& f) {
  const int steps = std::clamp(static_cast<int>(band.width_nm() / 20), 4, 200);
  double sum = 0;
  for (int i = 0; i < steps; ++i) sum += f(band.min_nm + band.width_nm() * (i + 0.5) / steps);
  return sum / steps;
}

void add_equal_bands(ChannelList& bands, double from, double to, double step) {
  for (double nm = from; nm < to - 1e-6; nm += step) bands.push_back({nm, nm + step, ""});
}

}  // namespace

ChannelList default_sky_bands() {
  ChannelList bands;
  add_equal_bands(bands, 380, 780, 10);
  add_equal_bands(bands, 780, 1400, 20);
  add_equal_bands(bands, 1400, 2500, 50);
  add_equal_bands(bands, 2500, 5000, 100);
  add_equal_bands(bands, 5000, 14000, 250);
  add_equal_bands(bands, 14000, 20000, 500);
  return bands;
}

void SkyMap::check() const {
  if (width_ < 8 || width_ > 65535)
    throw InputError("sky width " + std::to_string(width_) + ": must be from 8 to 65535");
  if (height_ < 5 || height_ > 65535 || height_ % 2 == 0)
    throw InputError("sky height " + std::to_string(height_) +
                     ": must be odd and from 5 to 65535, so that a row lies on the horizon");
  for (const Channel& band : bands_) {
    if (band.min_nm >= 300 && band.max_nm <= 100000) continue;
    throw InputError("sky band " + format_number(band.min_nm) + "-" + format_number(band.max_nm) +
                     " nm: the model goes from 300 to 100000 nm");
  }
}

SkyMap::SkyMap(const ClearSky& sky, ChannelList bands, uint32_t width, uint32_t height, bool with_sun)
    : sky_(sky),
      bands_(std::move(bands)),
      width_(width),
      height_(height),
      sun_mass_(air_mass(sky.parameters().sun_elevation_deg)) {
  check();
  for (uint32_t y = 0; y < height_; ++y) {
    rows_.push_back(make_row(y));
    add_thermal(rows_.back());
  }
  make_bands();
  scale_shapes();
  if (with_sun) spread_sun();
}

/// A texel's tent reaches from the row above to the row below: 1 on its own row, falling linearly in theta.
SkyMap::Row SkyMap::make_row(uint32_t y) const {
  const double step = kPi / (height_ - 1), theta = y * step;
  Row row;
  row.elevation_deg = 90 - 180.0 * y / (height_ - 1);
  row.sky = 2 * y <= height_ - 1;
  row.mass = air_mass(row.elevation_deg);
  const double part = 2 * kPi / width_ * step / kRowSteps;
  for (int i = -kRowSteps; i < kRowSteps; ++i) {
    const double t = (i + 0.5) / kRowSteps, angle = theta + t * step;
    if (angle < 0 || angle > kPi) continue;
    const double weight = (1 - std::abs(t)) * std::sin(angle) * part;
    row.solid_angle += weight;
    row.irradiance += weight * std::max(0.0, std::cos(angle));
  }
  return row;
}

void SkyMap::add_thermal(Row& row) const {
  if (!row.sky) return;
  for (const Channel& band : bands_) {
    const auto radiance = [&](double nm) { return sky_.thermal_radiance(nm, row.mass); };
    row.thermal.push_back(band.max_nm <= 2500 ? 0 : static_cast<float>(band_mean(band, radiance)));
  }
}

void SkyMap::make_bands() {
  const Spectrum direct = sky_.direct_normal(), rayleigh = sky_.rayleigh(), aerosol = sky_.aerosol(),
                 reflected = sky_.reflected();
  const double up = std::max(0.0, std::sin(sky_.parameters().sun_elevation_deg * kDegree));
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    const Channel& band = bands_[b];
    const auto mean = [&](const Spectrum& spectrum) { return spectrum.mean(band.min_nm, band.max_nm); };
    BandLight light;
    light.direct = mean(direct);
    light.rayleigh = mean(rayleigh);
    light.aerosol = mean(aerosol);
    light.reflected = mean(reflected);
    light.rayleigh_depth = sky_.rayleigh_depth(band.centre_nm());
    light.aerosol_depth = sky_.aerosol_depth(band.centre_nm());
    for (const Row& row : rows_)
      if (row.sky) light.thermal += width_ * row.irradiance * row.thermal[b];
    const double global =
        light.direct * up + light.rayleigh + light.aerosol + light.reflected + light.thermal;
    light.ground = band_mean(band, [&](double nm) {
      const double reflectance = sky_.ground_reflectance(nm);
      return reflectance * global / kPi +
             (1 - reflectance) * planck_radiance(nm, sky_.parameters().ground_temperature_k);
    });
    bands_light_.push_back(light);
  }
}

double SkyMap::diffuse(std::size_t b) const {
  return bands_light_[b].rayleigh + bands_light_[b].aerosol + bands_light_[b].reflected;
}

double SkyMap::cosine_to_sun(uint32_t x, const Row& row) const {
  const double azimuth = 2 * kPi * (x + 0.5) / width_ - sky_.parameters().sun_azimuth_deg * kDegree;
  const double e = row.elevation_deg * kDegree, s = sky_.parameters().sun_elevation_deg * kDegree;
  return std::sin(e) * std::sin(s) + std::cos(e) * std::cos(s) * std::cos(azimuth);
}

/// Single scattering in a layer, without phase function and albedo: with m the air mass of the view and m_s
/// of the sun, m / (m - m_s) (exp(-tau m_s) - exp(-tau m)), or tau m exp(-tau m) where they are equal.
double SkyMap::brightness(const BandLight& band, double mass) const {
  const double depth = band.rayleigh_depth + band.aerosol_depth, difference = mass - sun_mass_;
  if (std::abs(difference) < 1e-6 * mass) return depth * mass * std::exp(-depth * mass);
  return -mass / difference * std::exp(-depth * sun_mass_) * std::expm1(-depth * difference);
}

/// The shapes of scattered light are scaled so that their irradiances are the model's.
void SkyMap::scale_shapes() {
  for (const Row& row : rows_) {
    if (!row.sky) continue;
    double molecules = 0, particles = 0;
    for (uint32_t x = 0; x < width_; ++x) {
      const double cosine = cosine_to_sun(x, row);
      molecules += rayleigh_phase(cosine);
      particles += aerosol_phase(cosine);
    }
    for (BandLight& band : bands_light_) {
      const double light = brightness(band, row.mass) * row.irradiance;
      band.rayleigh_scale += molecules * light;
      band.aerosol_scale += particles * light;
    }
  }
  for (BandLight& band : bands_light_) {
    band.rayleigh_scale = band.rayleigh_scale > 0 ? band.rayleigh / band.rayleigh_scale : 0;
    band.aerosol_scale = band.aerosol_scale > 0 ? band.aerosol / band.aerosol_scale : 0;
  }
}

/// Points spread evenly over the disk (Vogel's spiral); each is given to the four texels around it in the
/// proportions of bilinear interpolation.
void SkyMap::spread_sun() {
  const SkyParameters& p = sky_.parameters();
  const double e = p.sun_elevation_deg * kDegree;
  if (e <= 0) return;
  const double golden = kPi * (3 - std::sqrt(5.0)), radius = kSunRadiusDeg * kDegree;
  for (int i = 0; i < kSunPoints; ++i) {
    const double r = radius * std::sqrt((i + 0.5) / kSunPoints), angle = golden * i;
    // In the frame of the sun: towards it, up along the meridian, and to the right.
    const double s = std::cos(r), up = std::sin(r) * std::cos(angle), right = std::sin(r) * std::sin(angle);
    const double high = s * std::sin(e) + up * std::cos(e), level = s * std::cos(e) - up * std::sin(e);
    if (high < 0) continue;
    const double azimuth = p.sun_azimuth_deg * kDegree + std::atan2(right, level);
    const double turn = azimuth / (2 * kPi) - std::floor(azimuth / (2 * kPi));
    const double column = turn * width_ - 0.5;
    const double line = std::acos(std::min(1.0, high)) / kPi * (height_ - 1);
    const double x = std::floor(column), y = std::min(std::floor(line), height_ - 2.0);
    for (int corner = 0; corner < 4; ++corner) {
      const int dx = corner & 1, dy = corner >> 1;
      const double share = (dx ? column - x : x + 1 - column) * (dy ? line - y : y + 1 - line);
      const auto tx = static_cast<uint32_t>((static_cast<int64_t>(x) + dx + width_) % width_);
      const auto ty = static_cast<uint32_t>(y) + static_cast<uint32_t>(dy);
      const auto same = [&](const SunTexel& t) { return t.x == tx && t.y == ty; };
      auto texel = std::ranges::find_if(sun_, same);
      if (texel == sun_.end()) texel = sun_.insert(sun_.end(), {tx, ty, 0});
      texel->density += share / (kSunPoints * rows_[ty].solid_angle);
    }
  }
}

void SkyMap::fill(uint32_t y0, uint32_t rows, std::span<float> out) const {
  float* to = out.data();
  std::vector<double> light(bands_.size());
  for (uint32_t y = y0; y < y0 + rows; ++y) {
    const Row& row = rows_[y];
    for (std::size_t b = 0; row.sky && b < light.size(); ++b)
      light[b] = brightness(bands_light_[b], row.mass);
    for (uint32_t x = 0; x < width_; ++x) {
      const double cosine = cosine_to_sun(x, row);
      const double molecules = rayleigh_phase(cosine), particles = aerosol_phase(cosine);
      double sun = 0;
      for (const SunTexel& texel : sun_)
        if (texel.x == x && texel.y == y) sun += texel.density;
      for (std::size_t b = 0; b < bands_.size(); ++b) {
        const BandLight& band = bands_light_[b];
        double radiance = sun * band.direct;
        if (row.sky) {
          radiance += light[b] * (molecules * band.rayleigh_scale + particles * band.aerosol_scale) +
                      band.reflected / kPi + row.thermal[b];
        } else {
          radiance += band.ground;
        }
        *to++ = static_cast<float>(radiance);
      }
    }
  }
}

}  // namespace kiloband
