// Samples whose value is not finite: both backends name the same ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "backend_images.hpp"
#include "scene/read/reader.hpp"

namespace kiloband::test::invalid_test {
namespace {

/// A lamp 1e-18 m before a wall: a sample that selects it is beyond floats. Others meet the directional
/// light, which is far brighter and so is selected nearly always.
const char* const kScene = R"(<scene version='3.0.0'>
<integrator type='path'><integer name='max_depth' value='2'/></integrator>
<sensor type='orthographic'>
 <transform name='to_world'><scale value='1e-9'/><lookat origin='0,0,1' target='0,0,0' up='0,1,0'/></transform>
 <film type='hdrfilm'><integer name='width' value='9'/><integer name='height' value='7'/><rfilter type='box'/></film>
</sensor>
<shape type='rectangle'/>
<emitter type='point'><point name='position' x='0' y='0' z='1e-18'/><spectrum name='intensity' value='0.01'/></emitter>
<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/>
 <spectrum name='irradiance' value='2'/></emitter></scene>)";

using Sample = std::tuple<uint32_t, uint32_t, uint32_t>;  // x, y, sample

std::vector<Sample> sorted(const std::vector<InvalidSample>& invalid) {
  std::vector<Sample> samples;
  for (const InvalidSample& s : invalid) samples.emplace_back(s.x, s.y, s.sample);
  std::ranges::sort(samples);
  return samples;
}

struct InvalidSamples : testing::Test {
  FlatScene scene =
      *compile_scene(read_scene_text(kScene, "invalid.xml", ".", {}), {parse_channels("500:600:4"), {}, {}});
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
