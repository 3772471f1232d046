// Measured line lists against line-by-line quadrature: CO at 1500 K and CO2 at 300 K (RADIS), where the
// public data are present. Channels wider and narrower than the lines. Error rate: 1e-4 for the whole
// program; detectable bias with each test.
#include "base/diagnostics.hpp"
#include "spectral/files/spectrum_files.hpp"
#include "spectral/planck.hpp"
#include "tests/statistical/analytic/gas/gas_scenes.hpp"
#include "tests/support/data_folder.hpp"

namespace kiloband::test::lines_test {
namespace {

struct Lines {
  const char* file;
  const char* bands;
  double metres, temperature_k;
  double largest_bias;
};

/// Exact for the data, which are piecewise linear: Simpson's rule on eight parts of every piece.
double quadrature(const Spectrum& kappa, const Channel& channel, const Lines& lines, double lamp) {
  std::vector<double> edges = {channel.min_nm};
  for (const double knot : kappa.knots_nm())
    if (knot > channel.min_nm && knot < channel.max_nm) edges.push_back(knot);
  edges.push_back(channel.max_nm);
  double sum = 0;
  for (std::size_t i = 1; i < edges.size(); ++i) {
    constexpr int kParts = 8;
    const double step = (edges[i] - edges[i - 1]) / kParts;
    for (int j = 0; j <= kParts; ++j) {
      const double nm = edges[i - 1] + j * step, x = kappa(nm) * lines.metres;
      const double weight = j == 0 || j == kParts ? 1 : j % 2 ? 4 : 2;
      sum += weight * step / 3 *
             (lamp * std::exp(-x) - planck_radiance(nm, lines.temperature_k) * std::expm1(-x));
    }
  }
  return sum;
}

class GasLines : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, GasLines, ::testing::ValuesIn(all_modes()), mode_name);

/// A slab of 1 m: `scale` stands for its thickness. Detectable bias: 10 % in 100 nm of CO, whose lines are a
/// thousandth as wide, 6 % elsewhere.
TEST_P(GasLines, MeasuredSpectraOfCoAndCo2) {
  const std::filesystem::path data = data_folder();
  if (data.empty()) GTEST_SKIP() << "no folder of public data";
  constexpr double kLamp = 0.02;
  for (const Lines& lines :
       {Lines{"CO_Tgas1500K_mole_fraction0.01.csv", "4500-4600, 4650-4651, 4652.2-4652.3", 0.5, 1500, 0.1},
        Lines{"CO2abscoeff_300K_4150_4400nm.txt", "4200-4300, 4250-4251, 4255.1-4255.2", 0.001, 300, 0.06}}) {
    SCOPED_TRACE(lines.file);
    const std::filesystem::path file = data / "spectra" / "gas" / lines.file;
    const std::string box =
        slab(0.5, 1.5,
             kNull + medium("absorbing", "interior",
                            "<spectrum name=\"absorption\" filename=\"" + file.string() + "\"/>" +
                                real("scale", lines.metres) + real("temperature", lines.temperature_k)));
    const RenderResult result =
        render_valid(scene(4, straight_camera(2) + black_lamp(spectrum("radiance", kLamp)) + box),
                     lines.bands, GetParam(), {512, 43});
    const Spectrum kappa = read_spectrum_file(file, ValueKind::kAbsorption);
    std::vector<double> expected;
    for (const Channel& channel : result.scene.channels)
      expected.push_back(quadrature(kappa, channel, lines, kLamp));
    expect_image_mean(result, expected, lines.largest_bias);
  }
}

}  // namespace
}  // namespace kiloband::test::lines_test
