// Samples whose value is not finite: both backends name the same ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "backend_images.hpp"

namespace kiloband::test::invalid_test {
namespace {

using Sample = std::tuple<uint32_t, uint32_t, uint32_t>;  // x, y, sample

std::vector<Sample> sorted(const std::vector<InvalidSample>& invalid) {
  std::vector<Sample> samples;
  for (const InvalidSample& s : invalid) samples.emplace_back(s.x, s.y, s.sample);
  std::ranges::sort(samples);
  return samples;
}

struct InvalidSamples : testing::Test {
  FlatScene scene = scene_beyond_floats(9, 7);
  SamplingSettings settings{WavelengthMode::kShared, SamplerType::kIndependent, 3, 2};
  std::unique_ptr<Backend> backend(const std::string& name) {
    return make_zoo_backend(name, scene, {}, settings);
  }
};

/// Few samples, so that the lists (of 16 at most) hold them all.
TEST_F(InvalidSamples, AreListedAlike) {
  const Image cpu = render_image(*backend("cpu"), scene, 2, 3);
  ASSERT_GT(cpu.invalid_samples, 0u);
  ASSERT_LE(cpu.invalid_samples, 16u) << "the lists do not hold them all";
  EXPECT_EQ(cpu.invalid.size(), cpu.invalid_samples);
  for (const std::string& method : kOpenclMethods) {
    const Image opencl = render_image(*backend(method), scene, 2, 3);
    EXPECT_EQ(opencl.invalid_samples, cpu.invalid_samples) << method;
    EXPECT_EQ(sorted(opencl.invalid), sorted(cpu.invalid)) << method;
    EXPECT_EQ(opencl.samples, cpu.samples) << method;
  }
}

/// Many: counts, the samples that every pixel keeps, and finite means that do not feel them.
TEST_F(InvalidSamples, LeaveTheMeanAlike) {
  const Image cpu = render_image(*backend("cpu"), scene, 2, 64);
  ASSERT_GT(cpu.invalid_samples, 16u);
  for (const std::string& method : kOpenclMethods) {
    const Image opencl = render_image(*backend(method), scene, 2, 64);
    EXPECT_EQ(opencl.invalid_samples, cpu.invalid_samples) << method;
    EXPECT_EQ(opencl.invalid.size(), 16u);
    EXPECT_EQ(opencl.samples, cpu.samples) << method;
    for (std::size_t i = 0; i < cpu.means.size(); ++i)
      ASSERT_NEAR(opencl.means[i], cpu.means[i], 1e-5 * cpu.means[i]) << method << ", value " << i;
  }
}

/// The paths themselves.
TEST_F(InvalidSamples, AreTracedAlike) {
  const auto cpu = backend("cpu"), opencl = backend("opencl:dpept-path");
  std::size_t invalid = 0;
  for (uint32_t i = 0; i < 16; ++i) {
    const auto a = cpu->trace(film_rect(scene), {i % 2, i / 2, 1});
    const auto b = opencl->trace(film_rect(scene), {i % 2, i / 2, 1});
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t p = 0; p < a.size(); ++p) {
      EXPECT_EQ(a[p].invalid, b[p].invalid) << "sample " << i << ", pixel " << p;
      invalid += a[p].invalid;
    }
  }
  EXPECT_GT(invalid, 0u);
}

}  // namespace
}  // namespace kiloband::test::invalid_test
