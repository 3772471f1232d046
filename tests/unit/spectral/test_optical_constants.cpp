#include <gtest/gtest.h>

#include <cmath>

#include "spectral/dispersion_formula.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "tests/support/messages.hpp"

namespace kiloband::test {
namespace {

OpticalConstants read_text(const std::string& name, const std::string& content,
                           std::vector<Diagnostic>* diagnostics = nullptr) {
  const TemporaryFolder folder;
  return read_optical_constants(folder.write(name, content), [&](const Diagnostic& d) {
    if (diagnostics) diagnostics->push_back(d);
  });
}

std::string yaml_formula(int number, const std::string& range, const std::string& coefficients) {
  return "COMMENTS: |\n    sample\nDATA:\n  - type: formula " + std::to_string(number) +
         "\n    wavelength_range: " + range + "\n    coefficients: " + coefficients + "\n";
}

// SCHOTT's data sheet of N-BK7: n_d (587.5618 nm) 1.51680, n_F (486.1327) 1.52238,
// n_C (656.2725) 1.51432, n_1529.6 1.50091.
TEST(OpticalConstants, BorosilicateGlassBySellmeier) {
  const OpticalConstants glass = read_text(
      "n.yml", yaml_formula(2, "0.3 2.5",
                            "0 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653"));
  EXPECT_NEAR(glass.n(587.5618), 1.51680, 5e-6);
  EXPECT_NEAR(glass.n(486.1327), 1.52238, 5e-6);
  EXPECT_NEAR(glass.n(656.2725), 1.51432, 5e-6);
  EXPECT_NEAR(glass.n(1529.6), 1.50091, 6e-6);
  EXPECT_FALSE(glass.k.has_value());
  EXPECT_EQ(glass.n(299), 0);
  EXPECT_EQ(glass.n(2501), 0);
  EXPECT_GT(glass.n(2500), 1);
}

// Each formula evaluated by hand at one wavelength.
TEST(OpticalConstants, FormulasByHand) {
  const auto n = [](int number, std::vector<double> c, double l) { return dispersion_formula(number, c, l); };
  EXPECT_NEAR(n(1, {0, 0.75, 0.5}, 1), std::sqrt(2.0), 1e-15);  // 1 + 0.75 / (1 - 0.25)
  EXPECT_NEAR(n(2, {0, 0.75, 0.25}, 1), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(n(2, {1, 3, 1}, 2), std::sqrt(6.0), 1e-15);            // 1 + 1 + 3 * 4 / 3
  EXPECT_NEAR(n(3, {2, 1, -2, 0.5, 1}, 2), std::sqrt(3.25), 1e-15);  // 2 + 1/4 + 0.5 * 2
  // 2 + 3 * 2 / (4 - 1^2) + 1 * 4 / (4 - 2^1) + 5 * 2^-1 = 2 + 2 + 2 + 2.5
  EXPECT_NEAR(n(4, {2, 3, 1, 1, 2, 1, 2, 2, 1, 5, -1}, 2), std::sqrt(8.5), 1e-15);
  EXPECT_NEAR(n(5, {1.5, 0.04, -2}, 2), 1.51, 1e-15);
  EXPECT_NEAR(n(6, {0, 0.05, 50}, 0.2), 1.002, 1e-15);  // 0.05 / (50 - 25)
  EXPECT_NEAR(n(7, {1, 0.028, 0.5, 1, 2, 3}, 1), 1 + 0.028 / 0.972 + 0.5 / (0.972 * 0.972) + 6, 1e-14);
  EXPECT_NEAR(n(8, {0.2, 0.1, 0.5, 0.05}, 1), std::sqrt((1 + 2 * 0.45) / 0.55), 1e-15);
  EXPECT_NEAR(n(9, {2, 0.5, 0.5, 1, 0.5, 0.25}, 1), std::sqrt(2 + 1 + 1), 1e-15);
  EXPECT_TRUE(std::isnan(n(1, {0, -9, 0.5}, 1)));
}

// Water at 20 C and 589.3 nm: 1.33299 in air (Daimon & Masumura 2007), whose index is 1.00027, so 1.33335 in
// vacuum; diamond 2.4173 at 589.3 nm (Peter 1923); CO2 at 0 C: n - 1 = 4.5e-4 (Bideau-Mehu 1973).
TEST(OpticalConstants, PublishedMaterials) {
  const auto water =
      read_text("w.yml", yaml_formula(2, "0.182 1.129",
                                      "0 5.684027565E-1 5.101829712E-3 1.726177391E-1 1.821153936E-2 "
                                      "2.086189578E-2 2.620722293E-2 1.130748688E-1 1.069792721E1"));
  EXPECT_NEAR(water.n(589.3), 1.33335, 2e-5);
  const auto diamond = read_text("c.yml", yaml_formula(1, "0.226 0.760", "0 0.3306 0.1750 4.3356 0.1060"));
  EXPECT_NEAR(diamond.n(589.3), 2.4173, 3e-4);
  const auto gas = read_text("g.yml", yaml_formula(6, "0.1807 1.6945",
                                                   "0 6.99100e-2 166.175 1.44720e-3 79.609 6.42941e-5 "
                                                   "56.3064 5.21306e-5 46.0196 1.46847e-6 0.0584738"));
  EXPECT_NEAR(gas.n(589.3), 1.00045, 3e-6);
}

TEST(OpticalConstants, FormulaTablesInterpolateBelowOnePartInAMillion) {
  const std::vector<double> steep = {0, 0.75, 0.04};  // resonance at 0.2 um, the range begins close to it
  const Spectrum table = tabulate_formula("t", 2, steep, 0.205, 12);
  for (int i = 0; i <= 100000; ++i) {
    const double um = 0.205 + (12 - 0.205) * std::pow(i / 100000.0, 3);
    ASSERT_NEAR(table(um * 1000), dispersion_formula(2, steep, um), 1e-6) << um;
  }
  EXPECT_LT(table.knots_nm().size(), 20000u);
}

TEST(OpticalConstants, TabulatedAndFormulaTogether) {
  const auto both =
      read_text("a.yml", yaml_formula(5, "0.4 0.8", "1.5") +
                             "  - type: tabulated k\n    data: |\n        0.5 0.1\n        0.7 0.3\n");
  EXPECT_NEAR(both.n(500), 1.5, 1e-12);
  EXPECT_DOUBLE_EQ((*both.k)(600), 0.2);
  EXPECT_EQ((*both.k)(450), 0);
}

TEST(OpticalConstants, TabulatedNk) {
  const std::string yaml =
      "DATA:\n  - type: tabulated nk\n    data: |\n        0.5 1 2\n        0.6 3 4\n        0.6 5 6\n       "
      " 0.7 8 9\n";
  std::vector<Diagnostic> diagnostics;
  const auto metal = read_text("a.yaml", yaml, &diagnostics);
  EXPECT_EQ(metal.n(600), 4);
  EXPECT_EQ((*metal.k)(600), 5);
  EXPECT_EQ((*metal.k)(700), 9);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].message, "wavelength 0.6 um: 2 rows are averaged");
  EXPECT_EQ(diagnostics[0].position.line, 5);
}

TEST(OpticalConstants, PlainText) {
  const auto metal = read_text("a.csv", "wavelength_um,n,k\n0.5,1,2\n0.6,3,4\n");
  EXPECT_EQ(metal.n(600), 3);
  EXPECT_EQ((*metal.k)(500), 2);
  const auto glass = read_text("a.txt", "500 1.5\n600 1.4\n");
  EXPECT_NEAR(glass.n(550), 1.45, 1e-12);
  EXPECT_FALSE(glass.k.has_value());
}

TEST(OpticalConstants, WrongFilesHaveTheirMessages) {
  const TemporaryFolder folder;
  const std::string entry = "DATA:\n  - type: ";
  const std::pair<std::string, const char*> cases[] = {
      {"", "f.yml: has no list DATA"},
      {"just text", "f.yml: has no list DATA"},
      {"DATA: 3\n", "f.yml: has no list DATA"},
      {"DATA: []\n", "f.yml: gives no n"},
      {"DATA:\n  - 3\n", "f.yml:2: an entry of DATA must have a type"},
      {"DATA:\n  - type: [1]\n", "f.yml:2: type: must be text"},
      {entry + "magic\n", "f.yml:2: type 'magic': must be tabulated n, k, nk or formula 1 to 9"},
      {entry + "formula 10\n", "f.yml:2: 'formula 10': must be formula 1 to 9"},
      {entry + "formula A\n", "f.yml:2: 'formula A': must be formula 1 to 9"},
      {yaml_formula(1, "0.5", "0 1 2"),
       "f.yml:4: wavelength_range '0.5': must be two increasing wavelengths in um"},
      {yaml_formula(1, "0.6 0.5", "0 1 2"),
       "f.yml:4: wavelength_range '0.6 0.5': must be two increasing wavelengths in um"},
      {yaml_formula(1, "0.6 x", "0 1 2"), "f.yml:4: 'x' is not a finite number"},
      {yaml_formula(1, "0.5 0.6", "0 nan"), "f.yml:4: 'nan' is not a finite number"},
      {yaml_formula(7, "0.5 0.6", "1 2 3 4 5 6 7"), "f.yml:4: 7 coefficients: formula 7 has 1 to 6"},
      {yaml_formula(1, "0.5 0.6", "-5"),
       "f.yml:4: formula 1 gives n = -nan at 0.5 um: must be positive and finite"},
      {yaml_formula(5, "0.5 0.6", "-1"),
       "f.yml:4: formula 5 gives n = -1 at 0.5 um: must be positive and finite"},
      {yaml_formula(5, "0.4 0.8", "1.5") + "  - type: tabulated n\n    data: 0.5 1\n",
       "f.yml: n is given twice"},
      {entry + "tabulated k\n    data: |\n      0.5 1\n", "f.yml: gives no n"},
      {entry + "tabulated nk\n    data: |\n      0.5 1\n", "f.yml:4: 2 columns: must be at least 3"},
      {entry + "tabulated n\n    data: |\n      0.5 1\n      0.4 1\n      0.6 1\n",
       "f.yml:6: wavelength 0.6 um after 0.4 um: the order changes"},
      {entry + "tabulated n\n    data: |\n      0.5 1\n      0.6 -1\n",
       "f.yml: n -1 at 600 nm: must be positive"},
      {entry + "tabulated nk\n    data: |\n      0.5 1 -1\n", "f.yml: k -1 at 500 nm: must be at least 0"},
      {entry + "tabulated n\n", "f.yml: no data"},
      {"DATA: [\n", "f.yml:2: not valid YAML: end of sequence flow not found"},
      {"DATA:\n\t- x\n", "f.yml:2: not valid YAML: illegal block entry"},
  };
  for (const auto& [content, message] : cases) {
    const auto file = folder.write("f.yml", content);
    EXPECT_EQ(error_of(folder, [&] { read_optical_constants(file); }), message) << content;
  }
}

TEST(OpticalConstants, HeadersSayWhichColumnIsWhich) {
  const auto values = [](const std::string& text) {
    const OpticalConstants read = read_text("a.csv", text);
    return std::pair(read.n(500), read.k ? (*read.k)(500) : -1);
  };
  EXPECT_EQ(values("nm,k,n\n400,1,2\n500,3,4\n"), (std::pair{4.0, 3.0}));
  EXPECT_EQ(values("nm;T (K);n;sigma;k\n400;300;2;0;1\n500;300;4;0;3\n"), (std::pair{4.0, 3.0}));
  EXPECT_EQ(values("nm,n,temperature\n400,2,300\n500,4,300\n"), (std::pair{4.0, -1.0}));
  EXPECT_EQ(values("nm,extinction coefficient,refractive index\n400,1,2\n500,3,4\n"), (std::pair{4.0, 3.0}));
  EXPECT_EQ(values("nm,a,b\n400,1,2\n500,3,4\n"), (std::pair{3.0, 4.0}));
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    return error_of(folder, [&] { read_optical_constants(folder.write("a.csv", text)); });
  };
  EXPECT_EQ(error("nm,eps1,eps2\n400,1,2\n500,3,4\n"),
            "a.csv: the header names a permittivity: n and k are needed");
  EXPECT_EQ(error("nm,Re(eps),Im(eps)\n400,1,2\n500,3,4\n"),
            "a.csv: the header names a permittivity: n and k are needed");
  EXPECT_EQ(values("nm,Re(n),Im(n)\n400,1,2\n500,3,4\n"), (std::pair{3.0, 4.0}));
  EXPECT_EQ(error("nm,k\n400,1\n500,3\n"), "a.csv: the header names k and no n");
  EXPECT_EQ(values("nm,n (%),k (%)\n400,150,300\n500,150,300\n"), (std::pair{1.5, 3.0}))
      << "as in a file of n alone";
  EXPECT_EQ(values("# nm  n  k  R%  T%\n400 1.5 3 61 0\n500 1.5 3 61 0\n"), (std::pair{1.5, 3.0}));
  EXPECT_EQ(values("# n and k fitted to measured reflectance in %\n400 1.5 3\n500 1.5 3\n"),
            (std::pair{1.5, 3.0}));
  EXPECT_EQ(values("nm;n;k;R (%)\n400;1.5;3;61\n500;1.5;3;61\n"), (std::pair{1.5, 3.0}));
  EXPECT_EQ(values("nm n J M\n400 1.5 3 1\n500 1.5 3 1\n"), (std::pair{1.5, -1.0}))
      << "initials are no units";
  EXPECT_EQ(error("nm,n (W/m2/nm)\n400,1\n500,3\n"),
            "a.csv: values in 'W/m2/nm': must be numbers without a unit, or percent");
}

TEST(OpticalConstants, DeepNestingIsAnErrorNotACrash) {
  const TemporaryFolder folder;
  for (const char* open : {"[", "{a: "}) {
    std::string nested = "DATA: ";
    for (int i = 0; i < 100000; ++i) nested += open;
    const auto file = folder.write("deep.yml", nested);
    EXPECT_THROW(read_optical_constants(file), InputError);
  }
}

TEST(OpticalConstants, ResonanceInsideTheRangeIsAnError) {
  const TemporaryFolder folder;
  const auto file = folder.write("f.yml", yaml_formula(6, "0.1 1", "0 1 25"));  // pole at 0.2 um
  EXPECT_THROW(read_optical_constants(file), InputError);
}

}  // namespace
}  // namespace kiloband::test
