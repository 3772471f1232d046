// Values that do not fit into the files' floats are counted, not silent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cube/cube_io.hpp"
#include "post/replicated_cube.hpp"
#include "render/session.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "tests/support/temporary_folder.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::overflow_test {
namespace {

constexpr uint32_t kSide = 16;  // pixels
constexpr std::size_t kBands = 5;

uint64_t count_infinite(const std::vector<float>& values) {
  return static_cast<uint64_t>(std::ranges::count_if(values, [](float v) { return std::isinf(v); }));
}

/// A sphere under a sky of that radiance, W m^-2 sr^-1 nm^-1, which the reader need not let through.
RenderReport render(double radiance, const SessionSettings& settings) {
  using namespace scene_text;
  const std::string xml = scene(-1, perspective(lookat("0, 0, 3", "0, 0, 0"), 50, film(kSide)) +
                                        shape("sphere", "") + emitter("constant", ""));
  SceneDescription description = read_scene_text(xml, "test.xml", ".");
  std::get<ConstantEmitter>(description.emitters.at(0).model).radiance = Spectrum::constant(radiance);
  const FlatScene scene = *compile_scene(description, {parse_channels("400:700:5"), {}, {}});
  SamplingSettings sampling;
  sampling.replicates = session_replicates(settings);
  const auto backend = cpu::make_backend(std::make_shared<const FlatScene>(scene), {}, sampling, {});
  return run_session(scene, {}, *backend, settings, false, {});
}

TEST(Overflow, IsCounted) {
  const test::TemporaryFolder folder;
  SessionSettings settings;
  settings.stop.samples_per_pixel = 8;
  settings.variance = settings.keep_replicates = true;
  settings.outputs = {folder.path() / "bright.hdr"};
  const RenderReport report = render(2e37, settings);  // 1.2e39 in a band of 60 nm

  std::vector<float> mean(kSide * kSide * kBands), variance(mean.size());
  open_cube(settings.outputs[0])->read_rows(0, kSide, mean, variance);
  EXPECT_GT(count_infinite(mean), 0u);
  EXPECT_GT(count_infinite(variance), 0u);
  EXPECT_EQ(report.overflowed_variances, count_infinite(variance));
  uint64_t expected = count_infinite(mean);
  for (uint32_t r = 0; r < report.replicates; ++r) {
    open_cube(replicate_path(settings.outputs[0], r))->read_rows(0, kSide, mean, {});
    expected += count_infinite(mean);
  }
  EXPECT_EQ(report.overflowed_values, expected);
  EXPECT_EQ(report.underflowed_values, 0u);
}

/// Radiances are floats, the squares of their errors are not: an error bar of 0 would say that they are exact.
TEST(Overflow, VariancesThatVanishAreCounted) {
  const test::TemporaryFolder folder;
  SessionSettings settings;
  settings.stop.samples_per_pixel = 8;
  settings.variance = true;
  settings.outputs = {folder.path() / "dark.hdr"};
  const RenderReport report = render(1e-26, settings);
  std::vector<float> mean(kSide * kSide * kBands), variance(mean.size());
  open_cube(settings.outputs[0])->read_rows(0, kSide, mean, variance);
  EXPECT_EQ(std::ranges::count(mean, 0.0f), 0);
  EXPECT_EQ(std::ranges::count(variance, 0.0f), static_cast<std::ptrdiff_t>(variance.size()));
  EXPECT_GT(report.underflowed_variances, 0u);
  EXPECT_EQ(report.underflowed_values, 0u);
}

}  // namespace
}  // namespace kiloband::overflow_test
