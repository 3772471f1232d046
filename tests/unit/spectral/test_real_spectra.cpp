// Every public file that users are likely to have must read; only where such files are at hand.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "spectral/colour/colour.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "tests/support/data_folder.hpp"

namespace kiloband::test {
namespace {

/// Calls `visit` for each file of a folder of spectra with the extension (all if empty); how many there were.
int for_each_file(const std::string& folder, const std::string& extension,
                  const std::function<void(const std::filesystem::path&)>& visit) {
  int count = 0;
  const std::filesystem::path root = data_folder("spectra");
  if (root.empty() || !std::filesystem::is_directory(root / folder)) return 0;
  for (const auto& entry : std::filesystem::directory_iterator(root / folder)) {
    if (!extension.empty() && entry.path().extension() != extension) continue;
    EXPECT_NO_THROW(visit(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0) << folder;
  return count;
}

void expect_resamples(const Spectrum& spectrum, const std::filesystem::path& file) {
  const RegularTable table = resample(spectrum, 300, 15000);
  const double magnitude =
      std::max(std::abs(spectrum.max_over(300, 15000)), std::abs(spectrum.min_over(300, 15000)));
  EXPECT_LE(table.max_error, 1.0001e-4 * magnitude) << file;
  for (std::size_t i = 0; i < spectrum.knots_nm().size(); ++i) {
    const double lambda_nm = spectrum.knots_nm()[i];
    if (lambda_nm > table.min_nm &&
        lambda_nm < table.min_nm + table.step_nm * static_cast<double>(table.values.size() - 1)) {
      ASSERT_NEAR(table(lambda_nm), spectrum.knot_values()[i], 1.0001e-4 * magnitude)
          << file << ' ' << lambda_nm;
    }
  }
}

TEST(RealSpectra, OpticalConstants) {
  for_each_file("refractiveindex.info", ".yml", [](const std::filesystem::path& file) {
    const OpticalConstants constants = read_optical_constants(file);
    EXPECT_GT(constants.n.data_range()->max_nm, constants.n.data_range()->min_nm);
    expect_resamples(constants.n, file);
    if (constants.k) expect_resamples(*constants.k, file);
  });
  const std::filesystem::path root = data_folder("spectra");
  if (root.empty()) return;
  const auto folder = root / "refractiveindex.info";
  EXPECT_NEAR(read_optical_constants(folder / "N-BK7.yml").n(587.56), 1.5168, 1e-5);
  EXPECT_NEAR(read_optical_constants(folder / "SF11.yml").n(587.56), 1.78472, 1e-5);  // SCHOTT
  EXPECT_NEAR(read_optical_constants(folder / "SiO2_Malitson.yml").n(587.56), 1.45846, 1e-5);
}

TEST(RealSpectra, Ecostress) {
  for_each_file("ecostress", ".txt", [](const std::filesystem::path& file) {
    const Spectrum spectrum = read_spectrum_file(file);
    EXPECT_GT(spectrum.data_range()->min_nm, 290) << file;
    EXPECT_GT(spectrum.data_range()->max_nm, 10000) << file;
    EXPECT_LT(spectrum.max_over(300, 16000), 1.1) << file;
    EXPECT_GT(spectrum.max_over(300, 16000), 0.01) << file;
    expect_resamples(spectrum, file);
  });
}

TEST(RealSpectra, Cie) {
  for_each_file("cie", ".csv", [](const std::filesystem::path& file) {
    EXPECT_GE(read_spectrum_file(file).knots_nm().size(), 81u) << file;
    EXPECT_GE(read_response_file(file).size(), 1u) << file;
  });
  const std::filesystem::path root = data_folder("spectra");
  if (root.empty()) return;
  const auto matching = read_response_file(root / "cie" / "cie1931_xyz_1nm.csv");
  ASSERT_EQ(matching.size(), 3u);
  EXPECT_EQ(matching[1].first, "y");
  for (double lambda_nm = 360; lambda_nm <= 830; lambda_nm += 5)
    EXPECT_NEAR(matching[1].second(lambda_nm), cie_y()(lambda_nm), 1e-6);
}

TEST(RealSpectra, ModisBands) {
  const std::pair<const char*, double> centres[] = {
      {"1", 646}, {"4", 554}, {"20", 3788}, {"29", 8550}, {"31", 11030}};
  for_each_file("sensor_rsr_modis_terra", ".final", [&](const std::filesystem::path& file) {
    for (const auto& [name, response] : read_response_file(file)) {
      const double area = response.integral(100, 20000);
      double first_moment = 0;
      for (double x = 300; x < 15000; x += 0.5) first_moment += 0.5 * x * response(x);
      for (const auto& [band, centre_nm] : centres)
        if (name.starts_with(std::string("band") + band + "_")) {
          EXPECT_NEAR(first_moment / area / centre_nm, 1, 0.01) << name;
        }
    }
  });
}

TEST(RealSpectra, SunAirAndGases) {
  const std::filesystem::path root = data_folder("spectra");
  if (root.empty()) return;
  const Spectrum sun = read_spectrum_file(root / "solar" / "ASTMG173.csv");
  EXPECT_NEAR(sun.integral(280, 4000), 1347.9, 1);  // W/m^2, ASTM G173-03
  const std::pair<const char*, double> totals[] = {
      {"extraterrestrial", 1347.9}, {"global", 1000.4}, {"direct", 900.1}};
  for (const auto& [name, spectrum] : read_response_file(root / "solar" / "ASTMG173.csv"))
    for (const auto& [column, total] : totals)
      if (name == column) {
        EXPECT_NEAR(spectrum.integral(280, 4000), total, 1) << name;
      }
  EXPECT_NEAR(read_spectrum_file(root / "atmosphere" / "modtran_ihaze1_alt1000m_range0m.csv")(300), 0.6700066,
              1e-9);
  const Spectrum co = read_spectrum_file(root / "gas" / "CO_Tgas1500K_mole_fraction0.01.csv");
  EXPECT_NEAR(co.data_range()->min_nm, 1e7 / 2272.1104, 1e-3);
  const Spectrum co2 = read_spectrum_file(root / "gas" / "CO2abscoeff_300K_4150_4400nm.txt");
  EXPECT_NEAR(co2.data_range()->min_nm, 4148.888, 1e-3);
}

}  // namespace
}  // namespace kiloband::test
