// What the analytic tests share: whole renders compared with closed forms.
//
// Every comparison is a t-test of a mean (of the image, or of one pixel) against an exact value, with the
// replicate variance that the film reports and R - 1 degrees of freedom. All comparisons of the program
// together, over tests, channels and pixels, raise a false alarm with probability kFamilyErrorRate at most
// (Sidak's bound, which dependence between channels only makes smaller). Seeds are fixed, so a run either
// always passes or always fails.
//
// A passing test says little if its error bar is wide. Tests of image means therefore also state the bias
// that they would detect with probability 0.9, (t_alpha + t_0.9) standard errors,
// and fail if it is larger than promised.
//
// Channels of a path are dependent, and so are pixels of a 32x32 block when they share wavelengths: means
// over the image are taken from replicate means of the image, never pooled from pixels.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/picture_files.hpp"
#include "tests/support/render_harness.hpp"
#include "tests/support/temporary_folder.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::test {

using namespace scene_text;

inline constexpr double kFamilyErrorRate = 1e-4;
/// Upper bound of the comparisons in this program; checked while they are made.
inline constexpr std::size_t kComparisons = 2000;
inline constexpr uint32_t kReplicates = 64;
/// Relative allowance for single precision and for tabulated spectra
/// (their stated bound is 1e-5 of the maximum).
inline constexpr double kRounding = 2e-5;

/// Wavelength mode and sampler, for parametrised tests.
struct Mode {
  WavelengthMode wavelengths = WavelengthMode::kShared;
  SamplerType sampler = SamplerType::kSobol;
  RoughDispersion rough_dispersion = RoughDispersion::kSpectralMis;
};
std::string name_of(const Mode& mode);
inline std::ostream& operator<<(std::ostream& out, const Mode& mode) {
  return out << name_of(mode);
}
std::vector<Mode> all_modes();
/// Those that a test goes through by itself: all of them on the CPU, one on other backends, as of parametrised tests
/// (CMakeLists.txt); tests/statistical/backends compares the others.
std::vector<Mode> tried_modes();
inline std::string mode_name(const ::testing::TestParamInfo<Mode>& info) {
  return name_of(info.param);
}

using Function = std::function<double(double)>;

/// A piecewise linear spectrum that scenes and closed forms both use.
struct Knots {
  std::vector<std::pair<double, double>> points;  // nm, value

  double operator()(double lambda_nm) const;
  /// <spectrum name="..." value="400:0.2, ..."/>
  std::string text(const std::string& name) const;
};

/// Integral of f over a channel (composite Simpson rule, 400 steps): f is smooth inside the channel.
double channel_integral(const Function& f, const Channel& channel);
/// The same for every channel of a render.
std::vector<double> channel_integrals(const Function& f, const RenderResult& result);

/// Views [-1, 1]^2 of the plane z = 0 from above.
std::string plane_sensor(uint32_t side);

// ---- renders and comparisons ----

struct Effort {
  uint64_t samples = 16;  // per pixel and replicate
  uint64_t seed = 1;
  uint32_t replicates = kReplicates;
};

/// What render_valid() renders.
RenderSpec spec_of(const std::string& xml, const std::string& bands, const Mode& mode, const Effort& effort,
                   const std::filesystem::path& folder);
/// Renders and requires that no sample was invalid.
RenderResult render_valid(const PreparedRender& prepared, const Effort& effort);
RenderResult render_valid(const std::string& xml, const std::string& bands, const Mode& mode = {},
                          const Effort& effort = {}, const std::filesystem::path& folder = ".");

/// Image means, channel by channel. largest_bias: promise for the detectable relative bias.
void expect_image_mean(const RenderResult& result, const std::vector<double>& expected, double largest_bias);
/// One pixel, channel by channel; nothing is promised about the detectable bias.
void expect_pixel(const RenderResult& result, uint32_t x, uint32_t y, const std::vector<double>& expected);
/// One mean; expected 0 demands exactly 0.
void expect_mean(const std::string& what, double mean, double variance, double expected, uint32_t replicates,
                 double largest_bias);
/// Every pixel and channel within kRounding: for renders that have no variance.
void expect_exactly(const RenderResult& result, const std::vector<double>& expected);

}  // namespace kiloband::test
