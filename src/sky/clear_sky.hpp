// A cloudless sky: irradiances of the scattered sun and radiance of the warm air, 0.3 to 100 um.
// docs/sky_model.md has the formulas and their sources.
#pragma once

#include <numbers>

#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

inline constexpr double kDegree = std::numbers::pi / 180;  // rad
inline constexpr double kAerosolAsymmetry = 0.65;          // mean cosine of its scattering

struct SkyParameters {
  double sun_elevation_deg = 45;  // -90 to 90; below 0 nothing is scattered: there is no twilight
  double sun_azimuth_deg = 180;   // from -Z towards +X
  double aerosol_500nm = 0.1;     // optical depth of the aerosol at 500 nm
  double water_cm = 1.5;          // precipitable water
  double ozone_atm_cm = 0.34;
  double pressure_hpa = 1013.25;
  double air_temperature_k = 288;  // at the ground
  double ground_temperature_k = 290;
  double ground_albedo = 0.2;       // below 3 um, for everything that is reflected
  double ground_emissivity = 0.97;  // above 4 um; linear between
};

/// throws InputError  "sun elevation 95 degrees: must be from -90 to 90"
void check_sky(const SkyParameters& sky);

/// Relative air mass at an elevation in degrees, at least 0: Kasten 1966, 36.5 at the horizon.
double air_mass(double elevation_deg);

/// The sky over a horizontal plane. All solar spectra are linear between the wavelengths of the tables.
class ClearSky {
 public:
  /// throws InputError as check_sky()
  explicit ClearSky(const SkyParameters& sky);

  const SkyParameters& parameters() const { return sky_; }

  // W m^-2 nm^-1; 0 where the sun is below the horizon.
  Spectrum extraterrestrial() const { return extraterrestrial_; }
  Spectrum direct_normal() const { return direct_; }  // on a plane that faces the sun
  /// Diffuse irradiance of the horizontal plane by its origin: scattered by molecules, by aerosol, and to and
  /// fro between ground and air.
  Spectrum rayleigh() const { return rayleigh_; }
  Spectrum aerosol() const { return aerosol_; }
  Spectrum reflected() const { return reflected_; }

  /// Vertical optical depths of scattering.
  double rayleigh_depth(double lambda_nm) const;
  double aerosol_depth(double lambda_nm) const;

  /// Transmission of the air's absorption bands along `mass` air masses, lambda >= 300 nm.
  struct Transmission {
    double air;    // water vapour and mixed gases, which are warm
    double ozone;  // which is cold
  };
  Transmission transmission(double lambda_nm, double mass) const;

  /// Radiance of the air, W m^-2 sr^-1 nm^-1. From below 2500 nm: 0.
  double thermal_radiance(double lambda_nm, double mass) const;
  /// Its irradiance on the horizontal plane over [min_nm, max_nm], W m^-2.
  double thermal_irradiance(double min_nm, double max_nm) const;

  double ground_reflectance(double lambda_nm) const;

 private:
  void add_solar(double lambda_nm, double extraterrestrial);

  SkyParameters sky_;
  std::vector<double> lambda_nm_, top_w_, direct_w_, rayleigh_w_, aerosol_w_, reflected_w_;
  Spectrum extraterrestrial_, direct_, rayleigh_, aerosol_, reflected_;
};

}  // namespace kiloband
