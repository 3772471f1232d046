// Built-in materials against published tables of the same models, data sheets and, where they are at hand,
// independent measurements (docs/materials.md shows the deviations that the last test prints).
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>

#include "spectral/materials/lorentz_drude.hpp"
#include "spectral/materials/materials.hpp"
#include "tests/support/data_folder.hpp"

namespace kiloband::test {
namespace {

/// A row of a table whose numbers are rounded to five digits.
struct Row {
  const char* metal;
  double lambda_um, n, k;
};

double half_a_digit(double rounded) {
  return 0.5 * std::pow(10, std::floor(std::log10(rounded)) - 4);
}

/// The built-in metal agrees with a rounded row: half a digit of the value, what half a digit of the
/// wavelength changes, and the table's own interpolation error of 1e-5.
void expect_row(const Row& row, const Spectrum& spectrum, double expected) {
  const double nm = 1000 * row.lambda_um, step = 1000 * half_a_digit(row.lambda_um);
  const auto range = *spectrum.data_range();
  double lowest = 1e9, highest = 0;
  for (int i = -10; i <= 10; ++i) {
    const double value = spectrum(std::clamp(nm + 0.1 * i * step, range.min_nm, range.max_nm));
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  const double slack = half_a_digit(expected) + 1e-5 * expected;
  EXPECT_GE(expected, lowest - slack) << row.metal << ' ' << row.lambda_um;
  EXPECT_LE(expected, highest + slack) << row.metal << ' ' << row.lambda_um;
}

/// refractiveindex.info tabulates the same model (pages "Rakic-LD", public domain).
TEST(BuiltInMetals, AgreeWithPublishedTablesOfTheModel) {
  constexpr Row kRows[] = {
      {"Ag", 0.25289, 0.50049, 1.3472}, {"Ag", 0.27358, 1.3888, 1.7832},  {"Ag", 12.398, 17.485, 76.626},
      {"Al", 226.33, 448.44, 501.56},   {"Al", 243.88, 467.81, 519.05},   {"Au", 0.61346, 0.33893, 2.9728},
      {"Au", 1.0129, 0.25970, 6.0788},  {"Au", 2.9938, 1.7542, 18.725},   {"Au", 6.0997, 4.9477, 37.527},
      {"Be", 58.335, 90.045, 158.53},   {"Be", 61.650, 95.192, 163.02},   {"Cr", 58.335, 73.251, 111.87},
      {"Cr", 61.650, 76.792, 114.77},   {"Cu", 0.66763, 0.30149, 3.8457}, {"Cu", 1.0075, 0.25557, 6.5372},
      {"Cu", 3.0602, 1.6332, 20.600},   {"Cu", 10.093, 8.3039, 64.879},   {"Ni", 0.34780, 1.6608, 2.1009},
      {"Ni", 0.50056, 1.7168, 2.9755},  {"Ni", 1.0007, 2.8011, 5.0401},   {"Pd", 11.876, 3.9412, 52.261},
      {"Pd", 12.350, 4.0799, 54.385},   {"Pt", 11.876, 15.491, 44.003},   {"Pt", 12.350, 16.411, 45.319},
      {"Ti", 29.391, 24.065, 37.621},   {"Ti", 30.847, 25.121, 38.540},   {"W", 11.876, 14.512, 50.749},
      {"W", 12.350, 15.468, 52.375}};
  for (const Row& row : kRows) {
    const auto metal = find_metal(row.metal);
    ASSERT_TRUE(metal) << row.metal;
    expect_row(row, metal->n, row.n);
    expect_row(row, *metal->k, row.k);
  }
}

/// One free electron without oscillators: eps = 1 - P^2 / (E^2 + i E G), by hand at E = 1 eV, P = 5 eV, G = 2
/// eV: 1 - 25 / (1 + 2i) = -4 + 10i.
TEST(BuiltInMetals, ModelByHand) {
  const LorentzDrude free{5, 1, 2, {}};
  const std::complex<double> index = lorentz_drude_index(free, kEvUm), squared = index * index;
  EXPECT_NEAR(squared.real(), -4, 1e-13);
  EXPECT_NEAR(squared.imag(), 10, 1e-13);
  EXPECT_GT(index.real(), 0);
  // An oscillator of strength 0.5 at 3 eV, width 1 eV: + 12.5 / (9 - 1 - i).
  const LorentzDrude bound{5, 1, 2, {{0.5, 3, 1}}};
  const std::complex<double> eps = std::pow(lorentz_drude_index(bound, kEvUm), 2);
  EXPECT_NEAR(eps.real(), -4 + 12.5 * 8 / 65, 1e-13);
  EXPECT_NEAR(eps.imag(), 10 + 12.5 / 65, 1e-13);
}

TEST(BuiltInMaterials, NamesAndRanges) {
  EXPECT_EQ(built_in_metals().size(), 11u);
  for (const BuiltInMaterial& m : built_in_metals()) {
    const auto metal = find_metal(m.name);
    ASSERT_TRUE(metal && metal->k) << m.name;
    EXPECT_NEAR(metal->n.data_range()->min_nm, m.min_nm, 1e-9) << m.name;
    EXPECT_NEAR(metal->k->data_range()->max_nm, m.max_nm, 1e-9) << m.name;
    EXPECT_LE(m.min_nm, 250) << m.name;
    EXPECT_GE(m.max_nm, m.name == "Pd" || m.name == "Pt" ? 12398 : 20000) << m.name;
    EXPECT_GT(metal->n.min_over(m.min_nm, m.max_nm), 0) << m.name;
    EXPECT_GT(metal->k->min_over(m.min_nm, m.max_nm), 0) << m.name;
    EXPECT_FALSE(find_dielectric(m.name)) << m.name;
  }
  for (const BuiltInMaterial& m : built_in_dielectrics()) {
    const auto index = find_dielectric(m.name);
    ASSERT_TRUE(index) << m.name;
    EXPECT_NEAR(index->data_range()->min_nm, m.min_nm, 1e-9) << m.name;
    EXPECT_NEAR(index->data_range()->max_nm, m.max_nm, 1e-9) << m.name;
    EXPECT_GT(index->min_over(m.min_nm, m.max_nm), m.name == "BaF2" || m.name == "CaF2" ? 0.9 : 1.0)
        << m.name;
    EXPECT_FALSE(find_metal(m.name)) << m.name;
  }
  EXPECT_TRUE(find_metal("AU"));
  EXPECT_TRUE(find_dielectric("Fused_Silica"));
  EXPECT_FALSE(find_metal("gold"));
  EXPECT_FALSE(find_dielectric(""));
}

/// Indices of catalogues and handbooks (SCHOTT: d line, 587.5618 nm; others as published, rounded there).
TEST(BuiltInDielectrics, AgreeWithDataSheets) {
  struct Sheet {
    const char* name;
    double lambda_nm, index, tolerance;
  };
  constexpr Sheet kSheets[] = {{"N-BK7", 587.5618, 1.51680, 5e-6},    {"SF11", 587.5618, 1.78472, 5e-6},
                               {"N-SF11", 587.5618, 1.78472, 5e-6},   {"F2", 587.5618, 1.62004, 5e-6},
                               {"fused_silica", 589.3, 1.4584, 1e-4}, {"CaF2", 589.3, 1.4338, 1e-4},
                               {"BaF2", 589.3, 1.4744, 2e-4},         {"MgF2", 589.3, 1.3777, 1e-4},
                               {"NaCl", 589.3, 1.5443, 3e-4},         {"KBr", 589.3, 1.5600, 2e-4},
                               {"sapphire", 589.3, 1.7681, 1e-4},     {"diamond", 589.3, 2.4173, 3e-4},
                               {"water", 589.3, 1.33335, 2e-5},       {"air", 589.3, 1.000277, 1e-6},
                               {"ZnSe", 10600, 2.4028, 1e-4},         {"ZnS", 10600, 2.1920, 1e-3},
                               {"Ge", 10600, 4.0040, 2e-3},           {"Si", 10600, 3.4180, 4e-3},
                               {"GaAs", 10600, 3.27, 1e-2},           {"water", 10000, 1.218, 1e-12}};
  for (const Sheet& s : kSheets)
    EXPECT_NEAR((*find_dielectric(s.name))(s.lambda_nm), s.index, s.tolerance)
        << s.name << ' ' << s.lambda_nm;
}

OpticalConstants file(const std::string& name) {
  return read_optical_constants(data_folder("spectra") / "refractiveindex.info" / name);
}

TEST(BuiltInDielectrics, AgreeWithFiles) {
  if (data_folder("spectra").empty()) GTEST_SKIP() << "no public spectra at hand";
  const std::pair<const char*, const char*> pairs[] = {{"air", "mixed-gases_air_nk_Ciddor.yml"},
                                                       {"air", "mixed-gases_air_nk_Mathar-1.3.yml"},
                                                       {"air", "mixed-gases_air_nk_Birch.yml"},
                                                       {"CaF2", "CaF2_Li.yml"},
                                                       {"CaF2", "CaF2_Malitson.yml"},
                                                       {"diamond", "C_Peter.yml"},
                                                       {"fused_silica", "SiO2_Malitson.yml"},
                                                       {"Ge", "Ge_Burnett.yml"},
                                                       {"N-BK7", "N-BK7.yml"},
                                                       {"N-SF11", "N-SF11.yml"},
                                                       {"SF11", "SF11.yml"},
                                                       {"sapphire", "Al2O3_Malitson-o.yml"},
                                                       {"Si", "Si_Chandler-Horowitz.yml"},
                                                       {"water", "H2O_Daimon-20.0C.yml"},
                                                       {"ZnSe", "ZnSe_Connolly.yml"}};
  for (const auto& [name, file_name] : pairs) {
    const Spectrum ours = *find_dielectric(name), theirs = file(file_name).n;
    const double from = std::max(ours.data_range()->min_nm, theirs.data_range()->min_nm);
    const double to = std::min(ours.data_range()->max_nm, theirs.data_range()->max_nm);
    double largest = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double nm = from + (to - from) * i / 1000;
      largest = std::max(largest, std::abs(ours(nm) - theirs(nm)));
    }
    std::printf("%-13s %-34s %7.0f - %6.0f nm  %.1e\n", name, file_name, from, to, largest);
    EXPECT_LT(largest, 1e-4) << name << ' ' << file_name;
  }
}

TEST(BuiltInMetals, SilverAgreesWithTheFileOfItsModel) {
  if (data_folder("spectra").empty()) GTEST_SKIP() << "no public spectra at hand";
  const OpticalConstants model = file("Ag_Rakic-LD.yml");
  const OpticalConstants ours = *find_metal("Ag");
  for (std::size_t i = 0; i < model.n.knots_nm().size(); ++i) {
    const Row row{"Ag", model.n.knots_nm()[i] / 1000, model.n.knot_values()[i], model.k->knot_values()[i]};
    expect_row(row, ours.n, row.n);
    expect_row(row, *ours.k, row.k);
  }
}

/// Unpolarised reflectance in air.
double reflectance(double n, double k, double cos_i) {
  const std::complex<double> index(n, k);
  const std::complex<double> cos_t = std::sqrt(1.0 - (1 - cos_i * cos_i) / (index * index));
  return 0.5 * (std::norm((cos_i - index * cos_t) / (cos_i + index * cos_t)) +
                std::norm((index * cos_i - cos_t) / (index * cos_i + cos_t)));
}

struct Window {
  const char* name;
  double min_nm, max_nm;
};
constexpr Window kWindows[] = {{"VIS", 380, 780},
                               {"NIR-SWIR", 780, 3000},
                               {"MWIR", 3000, 5000},
                               {"LWIR", 8000, 12000},
                               {"VLWIR", 12000, 20000}};

/// Largest |R(ours) - R(file)| at the file's own wavelengths; negative where it has none.
double largest_deviation(const OpticalConstants& ours, const OpticalConstants& theirs, const Window& window,
                         double cos_i) {
  double largest = -1;
  for (const double nm : theirs.n.knots_nm()) {
    const auto range = *ours.n.data_range();
    if (nm < std::max(window.min_nm, range.min_nm) || nm > std::min(window.max_nm, range.max_nm)) continue;
    largest = std::max(largest, std::abs(reflectance(ours.n(nm), (*ours.k)(nm), cos_i) -
                                         reflectance(theirs.n(nm), (*theirs.k)(nm), cos_i)));
  }
  return largest;
}

/// The models are fits; measurements of one metal differ among themselves. What is asserted is what
/// docs/materials.md states, per window and in reflectance.
TEST(BuiltInMetals, ReflectanceAgainstMeasurements) {
  if (data_folder("spectra").empty()) GTEST_SKIP() << "no public spectra at hand";
  struct Comparison {
    const char* metal;
    const char* file;
    double limits[5];  // by window
  };
  constexpr Comparison kComparisons[] = {{"Ag", "Ag_Johnson.yml", {0.137, 0.025, 0, 0, 0}},
                                         {"Ag", "Ag_Babar.yml", {0.124, 0.023, 0.012, 0.011, 0.012}},
                                         {"Al", "Al_Rakic.yml", {0.01, 0.008, 0.002, 0.002, 0.002}},
                                         {"Al", "Al_McPeak.yml", {0.014, 0.014, 0, 0, 0}},
                                         {"Al", "Al_Ordal.yml", {0.006, 0.011, 0.004, 0.003, 0.002}},
                                         {"Al", "Al_Rakic-BB.yml", {0.007, 0.005, 0.002, 0.001, 0.001}},
                                         {"Au", "Au_Johnson.yml", {0.07, 0.019, 0, 0, 0}},
                                         {"Au", "Au_Babar.yml", {0.101, 0.031, 0.019, 0.007, 0.007}},
                                         {"Au", "Au_Ordal.yml", {0.033, 0.016, 0.012, 0.001, 0.001}},
                                         {"Cr", "Cr_Rakic-BB.yml", {0.017, 0.015, 0.012, 0.005, 0.004}},
                                         {"Cr", "Cr_Sytchkova.yml", {0.047, 0.059, 0, 0, 0}},
                                         {"Cu", "Cu_Johnson.yml", {0.159, 0.011, 0, 0, 0}},
                                         {"Cu", "Cu_Babar.yml", {0.153, 0.031, 0.012, 0.004, 0.003}},
                                         {"Cu", "Cu_Ordal.yml", {0.084, 0.03, 0.002, 0.002, 0.001}},
                                         {"Cu", "Cu_Querry.yml", {0.181, 0.036, 0.002, 0.002, 0.001}},
                                         {"Ni", "Ni_Rakic-BB.yml", {0.008, 0.004, 0.003, 0, 0}},
                                         {"Pt", "Pt_Rakic-BB.yml", {0.003, 0.003, 0.001, 0.001, 0.001}},
                                         {"Ti", "Ti_Johnson.yml", {0.077, 0.04, 0, 0, 0}},
                                         {"Ti", "Ti_Ordal.yml", {0.041, 0.175, 0.062, 0.049, 0.038}},
                                         {"Ti", "Ti_Rakic-BB.yml", {0.1, 0.006, 0.005, 0.003, 0.004}},
                                         {"W", "W_Ordal.yml", {0.012, 0.015, 0.013, 0.005, 0.001}},
                                         {"W", "W_Rakic-BB.yml", {0.011, 0.008, 0.003, 0.003, 0.003}}};
  std::printf("| metal | file | VIS | NIR-SWIR | MWIR | LWIR | VLWIR |\n|---|---|---|---|---|---|---|\n");
  for (const Comparison& c : kComparisons) {
    const OpticalConstants ours = *find_metal(c.metal), theirs = file(c.file);
    std::printf("| %s | %s |", c.metal, c.file);
    for (std::size_t w = 0; w < std::size(kWindows); ++w) {
      const double normal = largest_deviation(ours, theirs, kWindows[w], 1);
      const double oblique = largest_deviation(ours, theirs, kWindows[w], 0.5);
      if (normal < 0) {
        std::printf(" |");
        continue;
      }
      std::printf(" %.3f / %.3f |", normal, oblique);
      EXPECT_LT(std::max(normal, oblique), c.limits[w])
          << c.metal << ' ' << c.file << ' ' << kWindows[w].name;
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace kiloband::test
