#include "tests/statistical/analytic/analytic_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiloband::test {
namespace {

std::size_t g_comparisons = 0;

/// (t_alpha, t_0.9) of one comparison among all.
std::pair<double, double> quantiles(uint32_t replicates) {
  static std::pair<uint32_t, std::pair<double, double>> last{0, {0, 0}};
  if (last.first != replicates) {
    // critical_t() is two-sided: a rate of 0.2 leaves 0.1 on one side.
    last = {replicates,
            {critical_t(kFamilyErrorRate, kComparisons, replicates), critical_t(0.2, 1, replicates)}};
  }
  return last.second;
}

std::string channel_label(const std::string& what, std::size_t channel) {
  return what + ", channel " + std::to_string(channel);
}

}  // namespace

std::string name_of(const Mode& mode) {
  return std::string(mode.wavelengths == WavelengthMode::kShared ? "shared" : "per_path") +
         (mode.sampler == SamplerType::kSobol ? "_sobol" : "_independent");
}

std::vector<Mode> all_modes() {
  return {{WavelengthMode::kShared, SamplerType::kSobol},
          {WavelengthMode::kShared, SamplerType::kIndependent},
          {WavelengthMode::kPerPath, SamplerType::kSobol},
          {WavelengthMode::kPerPath, SamplerType::kIndependent}};
}

std::vector<Mode> tried_modes() {
  if (test_backend_name() == "cpu") return all_modes();
  return {Mode{}};
}

double Knots::operator()(double lambda_nm) const {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const auto [x0, y0] = points[i - 1];
    const auto [x1, y1] = points[i];
    if (lambda_nm >= x0 && lambda_nm <= x1) return y0 + (y1 - y0) * (lambda_nm - x0) / (x1 - x0);
  }
  return 0;
}

std::string Knots::text(const std::string& name) const {
  std::string pairs;
  for (const auto& [nm, value] : points)
    pairs += (pairs.empty() ? "" : ", ") + exact(nm) + ":" + exact(value);
  return spectrum(name, pairs);
}

double channel_integral(const Function& f, const Channel& channel) {
  constexpr int kSteps = 400;
  const double step = channel.width_nm() / kSteps;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double weight = i == 0 || i == kSteps ? 1 : i % 2 ? 4 : 2;
    sum += weight * f(i == kSteps ? channel.max_nm : channel.min_nm + i * step);
  }
  return sum * step / 3;
}

std::vector<double> channel_integrals(const Function& f, const RenderResult& result) {
  std::vector<double> integrals;
  for (const Channel& channel : result.scene.channels) integrals.push_back(channel_integral(f, channel));
  return integrals;
}

std::string plane_sensor(uint32_t side) {
  return orthographic(lookat("0, 0, 5", "0, 0, 0"), 1, film(static_cast<int>(side)));
}

RenderSpec spec_of(const std::string& xml, const std::string& bands, const Mode& mode, const Effort& effort,
                   const std::filesystem::path& folder) {
  RenderSpec spec;
  spec.xml = xml;
  spec.bands = bands;
  spec.directory = folder;
  spec.threads = 1;  // images are one or a few blocks, and programs run side by side
  spec.spp = effort.samples * effort.replicates;
  spec.sampling = {mode.wavelengths, mode.sampler, effort.seed, effort.replicates, mode.rough_dispersion};
  return spec;
}

RenderResult render_valid(const PreparedRender& prepared, const Effort& effort) {
  RenderResult result = prepared.render();
  EXPECT_EQ(result.invalid_samples, 0u);
  EXPECT_EQ(result.replicates, effort.replicates);
  return result;
}

RenderResult render_valid(const std::string& xml, const std::string& bands, const Mode& mode,
                          const Effort& effort, const std::filesystem::path& folder) {
  return render_valid(PreparedRender(spec_of(xml, bands, mode, effort, folder)), effort);
}

void expect_mean(const std::string& what, double mean, double variance, double expected, uint32_t replicates,
                 double largest_bias) {
  ASSERT_LT(g_comparisons++, kComparisons) << "more comparisons than the error rate was divided by";
  ASSERT_GE(variance, 0) << what;
  const auto [t_alpha, t_power] = quantiles(replicates);
  const double error = std::sqrt(variance);
  const double rounding = kRounding * std::abs(expected);
  EXPECT_LE(std::abs(mean - expected), t_alpha * error + rounding)
      << what << ": mean " << mean << ", expected " << expected << " (" << (mean / expected - 1) * 100
      << " %), standard error " << error << ", t " << (mean - expected) / error;
  if (expected == 0) return;
  const double detectable = (t_alpha + t_power) * error + rounding;
  EXPECT_LE(detectable, largest_bias * std::abs(expected))
      << what << ": detectable bias " << detectable / expected * 100 << " %";
}

namespace {
/// Property of the running test in the report (--gtest_output=xml): the largest
/// of its comparisons of image means.
void record_detectable_bias(double bias) {
  static const ::testing::TestInfo* test = nullptr;
  static double largest = 0;
  const ::testing::TestInfo* running = ::testing::UnitTest::GetInstance()->current_test_info();
  largest = test == running ? std::max(largest, bias) : bias;
  test = running;
  ::testing::Test::RecordProperty("detectable_bias_percent", std::to_string(100 * largest));
}
}  // namespace

void expect_image_mean(const RenderResult& result, const std::vector<double>& expected, double largest_bias) {
  ASSERT_EQ(expected.size(), result.channels);
  double largest = 0;
  for (std::size_t c = 0; c < expected.size(); ++c) {
    expect_mean(channel_label("image", c), result.image_mean[c], result.image_variance[c], expected[c],
                result.replicates, largest_bias);
    const auto [t_alpha, t_power] = quantiles(result.replicates);
    if (expected[c] > 0)
      largest = std::max(largest,
                         (t_alpha + t_power) * std::sqrt(result.image_variance[c]) / expected[c] + kRounding);
  }
  record_detectable_bias(largest);
}

void expect_pixel(const RenderResult& result, uint32_t x, uint32_t y, const std::vector<double>& expected) {
  ASSERT_EQ(expected.size(), result.channels);
  for (std::size_t c = 0; c < expected.size(); ++c) {
    const std::size_t index = (std::size_t{y} * result.width + x) * result.channels + c;
    expect_mean(channel_label("pixel " + std::to_string(x) + " " + std::to_string(y), c), result.mean[index],
                result.variance[index], expected[c], result.replicates,
                std::numeric_limits<double>::infinity());
  }
}

void expect_exactly(const RenderResult& result, const std::vector<double>& expected) {
  ASSERT_EQ(expected.size(), result.channels);
  for (std::size_t i = 0; i < result.mean.size(); ++i) {
    const std::size_t c = i % result.channels;
    ASSERT_NEAR(result.mean[i], expected[c], kRounding * expected[c])
        << channel_label("pixel " + std::to_string(i / result.channels), c);
  }
}

}  // namespace kiloband::test
