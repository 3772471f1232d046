// Damaged files: readers return or throw InputError;
// anything else (a crash, another exception, a hang) fails the test.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "spectral/channels.hpp"
#include "spectral/spectrum_files.hpp"
#include "support.hpp"

namespace kiloband::test {
namespace {

/// 1 to 4 random edits: change, delete, insert, duplicate a part, cut the end; digits and separators more
/// often than rubbish.
std::string mutated(std::string text, std::mt19937& generator) {
  static const std::string alphabet = "0123456789.-+eE,; \t\n#:|[]{}&*!%nainf";
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(generator() % n); };
  for (std::size_t edits = 1 + below(4); edits-- > 0;) {
    const std::size_t at = below(text.size() + 1),
                      length = below(std::min<std::size_t>(text.size() - at + 1, 40));
    const char c = generator() % 4 ? alphabet[below(alphabet.size())] : static_cast<char>(generator() % 256);
    switch (generator() % 5) {
      case 0:
        if (at < text.size()) text[at] = c;
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, 1, c);
        break;
      case 3:
        text.insert(below(text.size() + 1), text.substr(at, length));
        break;
      default:
        if (generator() % 8 == 0) text.resize(at);
    }
  }
  return text;
}

struct Outcome {
  int read = 0, refused = 0;
};

Outcome damage(const std::string& name, const std::string& valid,
               const std::function<void(const std::filesystem::path&)>& read) {
  constexpr int kTimes = 2000;
  const TemporaryFolder folder;
  std::mt19937 generator(2024);
  Outcome outcome;
  EXPECT_NO_THROW(read(folder.write(name, valid)));
  for (int i = 0; i < kTimes; ++i) {
    const std::string content = mutated(valid, generator);
    try {
      read(folder.write(name, content));
      ++outcome.read;
    } catch (const InputError&) {
      ++outcome.refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << name << ": " << error.what() << "\n" << content;
    }
  }
  return outcome;
}

/// Both must happen, or the damage is not interesting.
void expect_both(const Outcome& outcome) {
  EXPECT_GT(outcome.read, 100);
  EXPECT_GT(outcome.refused, 100);
}

TEST(Robustness, SpectrumFile) {
  expect_both(damage(
      "a.csv", "# reflectance in percent\nwavelength_um,value\n0.4,10\n0.45,20\n0.5,22.5\n0.6,3e1\n0.8,5\n",
      [](const auto& file) { read_spectrum_file(file); }));
}

TEST(Robustness, EcostressFile) {
  expect_both(damage("a.txt",
                     "Name: Paint\r\nX Units: Wavelength (micrometers)\r\nY Units:Reflectance "
                     "(percent)\r\nNumber of X Values: 4\r\n\r\n"
                     " 0.3000\t 4.84\r\n 0.3020\t 4.96\r\n 0.304\t5.1\r\n 0.306 5.25\r\n",
                     [](const auto& file) { read_spectrum_file(file); }));
}

TEST(Robustness, OpticalConstantsTable) {
  expect_both(damage("a.yml",
                     "REFERENCES: |\n    <a href=\"x\">y</a>\nDATA:\n  - type: tabulated nk\n    data: |\n   "
                     "     0.25 0.44 1.17\n        0.2529 0.5 1.35\n        0.26 0.6 1.5\n        0.3 0.77 "
                     "1.7\nCONDITIONS:\n    temperature: 293\n",
                     [](const auto& file) { read_optical_constants(file); }));
}

TEST(Robustness, OpticalConstantsFormula) {
  expect_both(damage("a.yml",
                     "DATA:\n  - type: formula 2\n    wavelength_range: 0.3 2.5\n    coefficients: 0 "
                     "1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n",
                     [](const auto& file) { read_optical_constants(file); }));
}

TEST(Robustness, ResponseFile) {
  expect_both(damage(
      "a.csv",
      "wavelength_nm,x,y,z\n360,0.0001299,3.917e-06,0.0006061\n361,0.000145847,4.39e-06,0.00068\n362,1,2,3\n",
      [](const auto& file) { read_response_file(file); }));
}

TEST(Robustness, ChannelsFile) {
  expect_both(damage("a.csv", "min,max\n400,410\n410,420.5\n500,600\n",
                     [](const auto& file) { read_channels_file(file); }));
}

TEST(Robustness, ChannelsText) {
  const auto parse = [](const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    parse_channels(std::string(std::istreambuf_iterator<char>(stream), {}));
  };
  expect_both(damage("a", "8000:12000:64", parse));
  expect_both(damage("a", "400-410, 450-500, 8e3-12000.5", parse));
}

}  // namespace
}  // namespace kiloband::test
