// Damaged files: readers return or throw InputError.
#include <gtest/gtest.h>

#include <functional>

#include "spectral/channels.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "tests/support/mutations.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {
namespace {

/// Digits and separators more often than rubbish.
void expect_robust_file(const std::string& name, const std::string& valid,
                        const std::function<void(const std::filesystem::path&)>& read) {
  static const std::string kAlphabet = "0123456789.-+eE,; \t\n#:|[]{}&*!%nainf";
  Damage damage;
  damage.words.clear();
  for (const char c : kAlphabet) damage.words.emplace_back(1, c);
  const TemporaryFolder folder;
  expect_robust(valid, damage, 0.05, [&](const std::string& mutant) { read(folder.write(name, mutant)); });
}

TEST(Robustness, SpectrumFile) {
  expect_robust_file(
      "a.csv", "# reflectance in percent\nwavelength_um,value\n0.4,10\n0.45,20\n0.5,22.5\n0.6,3e1\n0.8,5\n",
      [](const auto& file) { read_spectrum_file(file); });
}

TEST(Robustness, EcostressFile) {
  expect_robust_file("a.txt",
                     "Name: Paint\r\nX Units: Wavelength (micrometers)\r\nY Units:Reflectance "
                     "(percent)\r\nNumber of X Values: 4\r\n\r\n"
                     " 0.3000\t 4.84\r\n 0.3020\t 4.96\r\n 0.304\t5.1\r\n 0.306 5.25\r\n",
                     [](const auto& file) { read_spectrum_file(file); });
}

TEST(Robustness, OpticalConstantsTable) {
  expect_robust_file("a.yml",
                     "REFERENCES: |\n    <a href=\"x\">y</a>\nDATA:\n  - type: tabulated nk\n    data: |\n   "
                     "     0.25 0.44 1.17\n        0.2529 0.5 1.35\n        0.26 0.6 1.5\n        0.3 0.77 "
                     "1.7\nCONDITIONS:\n    temperature: 293\n",
                     [](const auto& file) { read_optical_constants(file); });
}

TEST(Robustness, OpticalConstantsFormula) {
  expect_robust_file("a.yml",
                     "DATA:\n  - type: formula 2\n    wavelength_range: 0.3 2.5\n    coefficients: 0 "
                     "1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n",
                     [](const auto& file) { read_optical_constants(file); });
}

TEST(Robustness, ResponseFile) {
  expect_robust_file(
      "a.csv",
      "wavelength_nm,x,y,z\n360,0.0001299,3.917e-06,0.0006061\n361,0.000145847,4.39e-06,0.00068\n362,1,2,3\n",
      [](const auto& file) { read_response_file(file); });
}

TEST(Robustness, ChannelsFile) {
  expect_robust_file("a.csv", "min,max\n400,410\n410,420.5\n500,600\n",
                     [](const auto& file) { read_channels_file(file); });
}

TEST(Robustness, ChannelsText) {
  const auto parse = [](const std::filesystem::path& file) { parse_channels(read_file(file)); };
  expect_robust_file("a", "8000:12000:64", parse);
  expect_robust_file("a", "400-410, 450-500, 8e3-12000.5", parse);
}

}  // namespace
}  // namespace kiloband::test
