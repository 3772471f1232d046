#include "sky/clear_sky.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "sky/infrared_table.h"
#include "sky/spctral2_table.h"
#include "spectral/planck.hpp"

namespace kiloband {
namespace {

// Aerosol of the model's rural type (Bird and Riordan 1984, section 3).
constexpr double kAngstromExponent = 1.14;
constexpr double kAlbedo400 = 0.945;  // single scattering, at 400 nm
constexpr double kAlbedoSlope = 0.095;
constexpr double kDiffuseMass = 1.8;  // air mass of diffuse light
// The sun beyond its table: Planck's law at its effective temperature, scaled to meet the table at 4 um.
constexpr double kSunTemperatureK = 5772;
constexpr double kTableEndNm = 4000;
// Warm air: the further down it emits from, the more it absorbs.
constexpr double kLapseK = 10;        // what escapes comes from air that is colder by this at most
constexpr double kOzoneColderK = 50;  // than the air at the ground
constexpr double kWaterScaleHeightM = 2100;
constexpr double kThermalFromNm = 2500;

struct Absorption {
  double water = 0, mixed = 0, ozone = 0;
};

/// Coefficients between two rows of a table.
template <class Rows, class Mix>
Absorption interpolate(const Rows& rows, double lambda_nm, const Mix& mix) {
  const auto above = std::lower_bound(std::begin(rows) + 1, std::end(rows) - 1, lambda_nm,
                                      [](const auto& row, double nm) { return row.lambda_nm < nm; });
  const auto below = above - 1;
  const double t =
      std::clamp((lambda_nm - below->lambda_nm) / (above->lambda_nm - below->lambda_nm), 0.0, 1.0);
  return {mix(below->water, above->water, t), mix(below->mixed, above->mixed, t),
          mix(below->ozone, above->ozone, t)};
}

double linear_mix(double a, double b, double t) {
  return (1 - t) * a + t * b;
}
/// The coarse rows of the infrared change by powers of ten from one to the next.
double geometric_mix(double a, double b, double t) {
  return a > 0 && b > 0 ? std::exp(linear_mix(std::log(a), std::log(b), t)) : linear_mix(a, b, t);
}

Absorption absorption(double lambda_nm) {
  return lambda_nm <= kTableEndNm ? interpolate(kSpctral2, lambda_nm, linear_mix)
                                  : interpolate(kInfrared, lambda_nm, geometric_mix);
}

/// Band functions (Bird and Riordan 1984, equations 2-8 and 2-11): optical depths that grow like the square
/// root of strong absorbers.
double water_depth(double k, double path) {
  return 0.2385 * k * path / std::pow(1 + 20.07 * k * path, 0.45);
}
double mixed_depth(double k, double path) {
  return 1.41 * k * path / std::pow(1 + 118.93 * k * path, 0.45);
}

/// Vertical optical depth of the water vapour continuum (Roberts, Selby, Biberman 1976), whose strength goes
/// with the vapour's own pressure e and a little with that of the air; e falls with height like the vapour,
/// so that its mean along the path is half of that at the ground.
double continuum_depth(double lambda_nm, const SkyParameters& sky) {
  if (lambda_nm < 8000 || lambda_nm > 20000) return 0;
  const double wavenumber = 1e7 / lambda_nm;
  const double temperature_k = sky.air_temperature_k - 5;
  const double strength = (4.18 + 5578 * std::exp(-7.87e-3 * wavenumber)) *
                          std::exp(1800 * (1 / temperature_k - 1.0 / 296));  // cm^2 g^-1 atm^-1
  const double density = 10 * sky.water_cm / kWaterScaleHeightM;             // kg m^-3 at the ground
  const double vapour_atm = density * 461.5 * sky.air_temperature_k / 101325;
  return strength * sky.water_cm * (0.5 * vapour_atm + 0.002 * 0.8 * sky.pressure_hpa / 1013.25);
}

/// Ozone lies high: its air mass stays finite (equation 2-10).
double ozone_mass(double elevation_deg) {
  constexpr double kHeight = 22.0 / 6370;
  const double c = std::sin(elevation_deg * kDegree);
  return (1 + kHeight) / std::sqrt(c * c + 2 * kHeight);
}

/// The part of scattered light that goes forward, at the cosine of the sun's zenith angle
/// (equations 3-11 to 3-15).
double forward_part(double cosine) {
  const double a = std::log(1 - kAerosolAsymmetry);
  const double af = a * (1.459 + a * (0.1595 + a * 0.4129)), bf = a * (0.0783 + a * (-0.3824 - a * 0.5874));
  return 1 - 0.5 * std::exp((af + bf * cosine) * cosine);
}

double scattering_albedo(double lambda_nm) {
  const double l = std::log(lambda_nm / 400);
  return kAlbedo400 * std::exp(-kAlbedoSlope * l * l);
}

void check(bool ok, const char* name, double value, const char* rule) {
  if (!ok) throw InputError(std::string(name) + " " + format_number(value) + ": must be " + rule);
}

}  // namespace

void check_sky(const SkyParameters& s) {
  const auto within = [](double x, double low, double high) { return x >= low && x <= high; };
  check(within(s.sun_elevation_deg, -90, 90), "sun elevation", s.sun_elevation_deg, "from -90 to 90 degrees");
  check(within(s.sun_azimuth_deg, -360, 360), "sun azimuth", s.sun_azimuth_deg, "from -360 to 360 degrees");
  check(within(s.aerosol_500nm, 0, 5), "aerosol optical depth", s.aerosol_500nm, "from 0 to 5");
  check(within(s.water_cm, 0, 10), "precipitable water", s.water_cm, "from 0 to 10 cm");
  check(within(s.ozone_atm_cm, 0, 1), "ozone", s.ozone_atm_cm, "from 0 to 1 atm cm");
  check(within(s.pressure_hpa, 300, 1100), "pressure", s.pressure_hpa, "from 300 to 1100 hPa");
  check(within(s.air_temperature_k, 220, 330), "air temperature", s.air_temperature_k, "from 220 to 330 K");
  check(within(s.ground_temperature_k, 200, 400), "ground temperature", s.ground_temperature_k,
        "from 200 to 400 K");
  check(within(s.ground_albedo, 0, 1), "ground albedo", s.ground_albedo, "from 0 to 1");
  check(within(s.ground_emissivity, 0, 1), "ground emissivity", s.ground_emissivity, "from 0 to 1");
}

double air_mass(double elevation_deg) {
  const double zenith_deg = 90 - std::max(elevation_deg, 0.0);
  return 1 / (std::cos(zenith_deg * kDegree) + 0.15 * std::pow(93.885 - zenith_deg, -1.253));
}

ClearSky::ClearSky(const SkyParameters& sky) : sky_(sky) {
  check_sky(sky);
  for (const Spctral2Row& row : kSpctral2) add_solar(row.lambda_nm, row.extraterrestrial);
  const double scale = std::rbegin(kSpctral2)->extraterrestrial /
                       planck_radiance(kTableEndNm, kSunTemperatureK);  // sr, almost the sun's
  for (double nm = kTableEndNm + 50; nm <= 20000; nm += 50)
    add_solar(nm, scale * planck_radiance(nm, kSunTemperatureK));
  extraterrestrial_ = Spectrum::tabulated(lambda_nm_, top_w_);
  direct_ = Spectrum::tabulated(lambda_nm_, direct_w_);
  rayleigh_ = Spectrum::tabulated(lambda_nm_, rayleigh_w_);
  aerosol_ = Spectrum::tabulated(lambda_nm_, aerosol_w_);
  reflected_ = Spectrum::tabulated(lambda_nm_, reflected_w_);
}

double ClearSky::rayleigh_depth(double lambda_nm) const {
  const double um2 = lambda_nm * lambda_nm * 1e-6;
  return sky_.pressure_hpa / 1013 / (um2 * um2 * (115.6406 - 1.335 / um2));
}

double ClearSky::aerosol_depth(double lambda_nm) const {
  return sky_.aerosol_500nm * std::pow(lambda_nm / 500, -kAngstromExponent);
}

/// One wavelength of SPCTRAL2 (equations 2-1 to 3-17).
void ClearSky::add_solar(double nm, double top) {
  const double cosine = std::sin(sky_.sun_elevation_deg * kDegree);
  lambda_nm_.push_back(nm);
  top_w_.push_back(top);
  if (cosine <= 0) {
    for (auto* values : {&direct_w_, &rayleigh_w_, &aerosol_w_, &reflected_w_}) values->push_back(0);
    return;
  }
  const double mass = air_mass(sky_.sun_elevation_deg), albedo = scattering_albedo(nm);
  const double rayleigh = std::exp(-rayleigh_depth(nm) * mass), aerosol = aerosol_depth(nm);
  const double ozone =
      std::exp(-absorption(nm).ozone * sky_.ozone_atm_cm * ozone_mass(sky_.sun_elevation_deg));
  const double gases = transmission(nm, mass).air;
  const double absorbed = std::exp(-(1 - albedo) * aerosol * mass);
  const double scattered = std::exp(-albedo * aerosol * mass);
  const double common = top * cosine * ozone * gases * absorbed;
  const double correction = nm <= 450 ? std::pow((nm + 550) / 1000, 1.8) : 1;
  const double direct = top * rayleigh * scattered * absorbed * ozone * gases;
  const double by_molecules = 0.5 * common * (1 - std::pow(rayleigh, 0.95)) * correction;
  const double by_aerosol =
      common * std::pow(rayleigh, 1.5) * (1 - scattered) * forward_part(cosine) * correction;

  // What the ground sends up comes back in part: the reflectance of the sky for diffuse light.
  const double r = std::exp(-rayleigh_depth(nm) * kDiffuseMass);
  const double sky = transmission(nm, kDiffuseMass).air * std::exp(-(1 - albedo) * aerosol * kDiffuseMass) *
                     (0.5 * (1 - r) + (1 - forward_part(1 / kDiffuseMass)) * r *
                                          (1 - std::exp(-albedo * aerosol * kDiffuseMass)));
  const double to_and_fro = sky * ground_reflectance(nm) / (1 - sky * ground_reflectance(nm));
  direct_w_.push_back(direct);
  rayleigh_w_.push_back(by_molecules);
  aerosol_w_.push_back(by_aerosol);
  reflected_w_.push_back((direct * cosine + by_molecules + by_aerosol) * to_and_fro);
}

ClearSky::Transmission ClearSky::transmission(double lambda_nm, double mass) const {
  const Absorption k = absorption(lambda_nm);
  const double pressure = sky_.pressure_hpa / 1013;
  const double depth = water_depth(k.water, sky_.water_cm * mass) + mixed_depth(k.mixed, pressure * mass) +
                       continuum_depth(lambda_nm, sky_) * mass;
  return {std::exp(-depth), std::exp(-k.ozone * sky_.ozone_atm_cm * std::min(mass, ozone_mass(0)))};
}

double ClearSky::thermal_radiance(double lambda_nm, double mass) const {
  if (lambda_nm < kThermalFromNm) return 0;
  const Transmission t = transmission(lambda_nm, mass);
  const double air = sky_.air_temperature_k - kLapseK * t.air;
  return (1 - t.air) * planck_radiance(lambda_nm, air) +
         t.air * (1 - t.ozone) * planck_radiance(lambda_nm, sky_.air_temperature_k - kOzoneColderK);
}

/// 2 pi int_0^1 L(c) c dc by Gauss's rule with 6 points in c, and the midpoint rule in wavelength.
double ClearSky::thermal_irradiance(double min_nm, double max_nm) const {
  constexpr std::array<double, 6> kNodes{0.0337652429, 0.1693953068, 0.3806904070,
                                         0.6193095930, 0.8306046932, 0.9662347571};
  constexpr std::array<double, 6> kWeights{0.0856622462, 0.1803807865, 0.2339569673,
                                           0.2339569673, 0.1803807865, 0.0856622462};
  double sum = 0;
  for (double nm = min_nm; nm < max_nm;) {
    const double step = std::min(std::max(20.0, 0.002 * nm), max_nm - nm);
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      const double mass = air_mass(std::asin(kNodes[i]) / kDegree);
      sum += 2 * std::numbers::pi * kWeights[i] * kNodes[i] * step * thermal_radiance(nm + 0.5 * step, mass);
    }
    nm += step;
  }
  return sum;
}

double ClearSky::ground_reflectance(double lambda_nm) const {
  const double t = std::clamp((lambda_nm - 3000) / 1000, 0.0, 1.0);
  return (1 - t) * sky_.ground_albedo + t * (1 - sky_.ground_emissivity);
}

}  // namespace kiloband
