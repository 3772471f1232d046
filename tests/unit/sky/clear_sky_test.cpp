// The sky's irradiances against published figures: broadband sunlight, ASTM G173,
// empirical formulas of thermal radiation.
#include "sky/clear_sky.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "spectral/files/spectrum_files.hpp"
#include "spectral/planck.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

constexpr double kStefanBoltzmann = 5.670374e-8;

std::string error_of(const SkyParameters& sky) {
  return test::error_of([&] { check_sky(sky); });
}

TEST(ClearSky, ParametersHaveTheirRanges) {
  EXPECT_EQ(error_of({}), "accepted");
  EXPECT_EQ(error_of({.sun_elevation_deg = 95}), "sun elevation 95: must be from -90 to 90 degrees");
  EXPECT_EQ(error_of({.sun_azimuth_deg = 361}), "sun azimuth 361: must be from -360 to 360 degrees");
  EXPECT_EQ(error_of({.aerosol_500nm = -0.1}), "aerosol optical depth -0.1: must be from 0 to 5");
  EXPECT_EQ(error_of({.water_cm = 11}), "precipitable water 11: must be from 0 to 10 cm");
  EXPECT_EQ(error_of({.ozone_atm_cm = 2}), "ozone 2: must be from 0 to 1 atm cm");
  EXPECT_EQ(error_of({.pressure_hpa = 100}), "pressure 100: must be from 300 to 1100 hPa");
  EXPECT_EQ(error_of({.air_temperature_k = 15}), "air temperature 15: must be from 220 to 330 K");
  EXPECT_EQ(error_of({.ground_temperature_k = 500}), "ground temperature 500: must be from 200 to 400 K");
  EXPECT_EQ(error_of({.ground_albedo = 1.5}), "ground albedo 1.5: must be from 0 to 1");
  EXPECT_EQ(error_of({.ground_emissivity = std::nan("")}), "ground emissivity nan: must be from 0 to 1");
}

/// 1 at the zenith (within 0.1 %), 1.994 at 30 degrees (Kasten and Young 1989),
/// 36.5 at the horizon (Kasten 1966).
TEST(ClearSky, AirMass) {
  EXPECT_NEAR(air_mass(90), 1, 1e-3);
  EXPECT_NEAR(air_mass(30), 1.994, 2e-3);
  EXPECT_NEAR(air_mass(0), 36.5, 0.1);
  EXPECT_EQ(air_mass(-10), air_mass(0));
}

/// The solar constant but for what lies below 300 nm (1.2 %).
TEST(ClearSky, TopOfTheAtmosphere) {
  EXPECT_NEAR(ClearSky({}).extraterrestrial().integral(300, 20000), 1361 * 0.988, 0.01 * 1361);
}

/// Direct sunlight of clear air with a high sun: 700 to 1000 W/m^2; less with more water, aerosol, air.
TEST(ClearSky, BroadbandDirectSunlight) {
  const auto direct = [](SkyParameters sky) { return ClearSky(sky).direct_normal().integral(300, 20000); };
  const SkyParameters high{.sun_elevation_deg = 70};
  EXPECT_GT(direct(high), 700);
  EXPECT_LT(direct(high), 1000);
  EXPECT_LT(direct({.sun_elevation_deg = 70, .water_cm = 4}), direct(high));
  EXPECT_LT(direct({.sun_elevation_deg = 70, .aerosol_500nm = 0.4}), direct(high));
  EXPECT_LT(direct({.sun_elevation_deg = 10}), 0.75 * direct(high));
  EXPECT_EQ(direct({.sun_elevation_deg = -1}), 0);
  EXPECT_EQ(ClearSky({.sun_elevation_deg = -1}).rayleigh().integral(300, 20000), 0);
}

/// Clear skies are blue: molecules scatter more at 450 nm than at 650 nm, by a little
/// more than (650/450)^4 = 4.35 because the index of air falls with wavelength.
TEST(ClearSky, ScatteredLightIsBlue) {
  const ClearSky sky({.aerosol_500nm = 0});
  EXPECT_GT(sky.rayleigh_depth(450) / sky.rayleigh_depth(650), 4.35);
  EXPECT_LT(sky.rayleigh_depth(450) / sky.rayleigh_depth(650), 4.55);
  EXPECT_NEAR(sky.rayleigh_depth(550), 0.097, 0.002);  // published: 0.0973 (Bodhaine et al. 1999)
  EXPECT_GT(sky.rayleigh()(450) / sky.extraterrestrial()(450),
            3 * sky.rayleigh()(650) / sky.extraterrestrial()(650));
  EXPECT_EQ(sky.aerosol().integral(300, 4000), 0);
}

/// Prata 1996: emissivity 1 - (1 + w) exp(-sqrt(1.2 + 3 w)), w = 46.5 e / T cm, e in hPa. Required: 15 %;
/// held here: 10 % below half a centimetre of water, 5 % elsewhere. What is seen is recorded.
TEST(ClearSky, ThermalRadiationOfTheAirAgreesWithPrata) {
  double lowest = 0, highest = 0, lowest_of_dry = 0;
  for (const double temperature : {263.0, 273.0, 283.0, 293.0, 303.0}) {
    for (const double humidity : {0.3, 0.6, 0.9}) {
      const double celsius = temperature - 273.15;
      const double vapour = humidity * 6.112 * std::exp(17.62 * celsius / (celsius + 243.12));  // Magnus
      const double water = 46.5 * vapour / temperature;
      const double expected = (1 - (1 + water) * std::exp(-std::sqrt(1.2 + 3 * water))) * kStefanBoltzmann *
                              std::pow(temperature, 4);
      const ClearSky sky({.water_cm = water, .air_temperature_k = temperature});
      const double irradiance = sky.thermal_irradiance(3000, 100000);
      EXPECT_NEAR(irradiance / expected, 1, water < 0.5 ? 0.1 : 0.05) << temperature << " K, " << humidity;
      double& low = water < 0.5 ? lowest_of_dry : lowest;
      low = std::min(low, irradiance / expected - 1);
      highest = std::max(highest, irradiance / expected - 1);
      if (temperature > 270 && temperature < 300) {
        EXPECT_GT(irradiance, 200);
        EXPECT_LT(irradiance, 400);
      }
    }
  }
  RecordProperty("lowest", std::to_string(lowest));
  RecordProperty("lowest_of_dry_air", std::to_string(lowest_of_dry));
  RecordProperty("highest", std::to_string(highest));
}

/// The window from 8 to 13 um is colder than the bands beside it, and colder at the zenith
/// than at the horizon.
TEST(ClearSky, TheWindowIsCold) {
  const ClearSky sky({});
  const auto brightness = [&](double nm,
                              double mass) {  // radiance over that of a black body at air temperature
    return sky.thermal_radiance(nm, mass) / planck_radiance(nm, sky.parameters().air_temperature_k);
  };
  for (const double nm : {8600.0, 9000.0, 10500.0, 11000.0, 12000.0}) EXPECT_LT(brightness(nm, 1), 0.5) << nm;
  for (const double nm : {5800.0, 6500.0, 7000.0, 14500.0, 15000.0}) EXPECT_GT(brightness(nm, 1), 0.97) << nm;
  EXPECT_GT(brightness(9600, 1), brightness(9000, 1));  // ozone
  EXPECT_GT(brightness(10500, 30), 2 * brightness(10500, 1));
  const ClearSky humid({.water_cm = 5});
  EXPECT_GT(humid.thermal_radiance(11000, 1), 2 * sky.thermal_radiance(11000, 1));
}

/// ASTM G173-03: air mass 1.5, aerosol 0.084 at 500 nm, 1.42 cm of water, 0.344 atm cm of ozone. Its "direct"
/// includes the circumsolar light. Only where the file is at hand. Required: 3 % of the total, 6 % of the
/// mean in 100 nm from 400 nm on outside water bands; seen: see docs/sky_model.md.
TEST(ClearSky, AgreesWithTheReferenceSpectrum) {
  const std::filesystem::path file = data_folder("spectra") / "solar" / "ASTMG173.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no reference spectra at hand";
  std::optional<Spectrum> reference;
  for (const auto& [name, spectrum] : read_response_file(file))
    if (name == "direct") reference = spectrum;
  ASSERT_TRUE(reference);
  const ClearSky sky(
      {.sun_elevation_deg = 41.81, .aerosol_500nm = 0.084, .water_cm = 1.42, .ozone_atm_cm = 0.344});
  EXPECT_NEAR(reference->integral(280, 4000), 900.1, 0.5);  // published total of the direct spectrum, W/m^2
  const double total = sky.direct_normal().integral(300, 4000) / reference->integral(300, 4000) - 1;
  RecordProperty("deviation_of_total", std::to_string(total));
  EXPECT_LT(std::abs(total), 0.03);
  double largest = 0;
  for (double nm = 400; nm < 1800; nm += 100) {
    if (nm == 900 || nm == 1100 || nm == 1300 || nm == 1400) continue;
    const double deviation = sky.direct_normal().mean(nm, nm + 100) / reference->mean(nm, nm + 100) - 1;
    EXPECT_LT(std::abs(deviation), 0.06) << nm;
    largest = std::max(largest, std::abs(deviation));
  }
  RecordProperty("largest_deviation", std::to_string(largest));
}

/// MODTRAN 5, mid-latitude summer, the lowest kilometre straight down, which has 11.4 % of the air, 40 % of
/// the 2.9 cm of water and an aerosol of about 0.02. Only where the file is at hand. Two paths stand for it:
/// one with its gases for 4 to 5 um, one with its water beyond, which has 62 % of its continuum. This is what
/// the infrared coefficients were fitted to; means over 1 um agree within 0.07.
TEST(ClearSky, AgreesWithTransmissionsOfTheLowestKilometre) {
  const std::filesystem::path file =
      data_folder("spectra") / "atmosphere" / "modtran_ihaze1_alt1000m_range0m.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no atmosphere at hand";
  const Spectrum reference = read_spectrum_file(file);
  const ClearSky gases({.water_cm = 10, .ozone_atm_cm = 0, .air_temperature_k = 294});
  const ClearSky water({.water_cm = 2.92, .ozone_atm_cm = 0, .air_temperature_k = 294});
  double largest = 0;
  for (double nm = 4000; nm < 13000; nm += 1000) {
    double mean = 0;
    for (int i = 0; i < 100; ++i) {
      const double lambda_nm = nm + 10 * i + 5;
      const auto t = nm < 5000 ? gases.transmission(lambda_nm, 0.116) : water.transmission(lambda_nm, 0.4);
      mean += t.air * std::exp(-0.02) / 100;
    }
    EXPECT_NEAR(mean, reference.mean(nm, nm + 1000), 0.07) << nm;
    largest = std::max(largest, std::abs(mean - reference.mean(nm, nm + 1000)));
  }
  RecordProperty("largest_difference", std::to_string(largest));
}

}  // namespace
}  // namespace kiloband::test
