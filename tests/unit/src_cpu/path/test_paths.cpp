// What the film holds is what the saved paths say; and the modes estimate the same thing.
#include <gtest/gtest.h>

#include <cmath>

#include "room_scene.hpp"
#include "src_cpu/evaluate/evaluator.hpp"
#include "src_cpu/path/path_tracer.hpp"
#include "tests/support/temporary_folder.hpp"
#include "validation/oracle/evaluate_reference.hpp"

namespace kiloband::test::test_paths {

using namespace cpu;
namespace {

constexpr uint32_t kSize = 20;

/// Of those that this machine and this build have (KILOBAND_NATIVE has one).
Isa lowest_isa() {
  for (const Isa isa : {Isa::kSse4, Isa::kAvx2})
    if (is_available(isa)) return isa;
  return Isa::kAvx512;
}

/// The render of `spec` again, without SIMD, film or floats: every sample traced, its paths evaluated in
/// double and summed.
std::vector<double> reference_means(const RenderSpec& spec, const RenderResult& result) {
  const FlatScene& scene = result.scene;
  DerivedChannels derived;
  for (const auto& [name, response] : spec.responses) {
    const Channel range = hull(scene.channels);
    derived.names.push_back(name);
    derived.responses.push_back(resample(response, range.min_nm, range.max_nm));
  }
  const EmbreeScene embree(scene, lowest_isa(), 1);
  const TracerScene tracer_scene{&scene, &embree};
  SamplingSettings settings = spec.sampling;
  settings.replicates = result.replicates;
  PathTracer tracer(tracer_scene, settings, one_lane_path_kernels());

  std::vector<double> sums(result.mean.size());
  const bool shared = settings.wavelengths == WavelengthMode::kShared;
  const uint32_t sampler =
      settings.sampler == SamplerType::kSobol ? KB_SAMPLER_SOBOL : KB_SAMPLER_INDEPENDENT;
  PathBuffer paths;
  std::vector<uint32_t> invalid;
  for (uint32_t sample = 0; sample < spec.spp; ++sample) {
    const SampleId id{sample, sample % result.replicates, sample / result.replicates};
    std::vector<float> mu(shared ? 1 : kSize * kSize);
    for (uint32_t i = 0; i < mu.size(); ++i) {
      mu[i] = shared ? kb_shared_mu(settings.seed, id.replicate, 0, 0, id.index)
                     : kb_path_mu(sampler, settings.seed, i, id.sample, id.replicate, id.index);
    }
    tracer.trace({0, 0, kSize, kSize}, id, mu, paths, invalid);
    for (std::size_t p = 0; p < paths.paths.size(); ++p) {
      const uint32_t pixel = paths.paths[p].pixel;
      const std::vector<double> value =
          evaluate_path_reference(scene, derived, paths, p, mu[shared ? 0 : pixel]);
      for (std::size_t c = 0; c < value.size(); ++c) sums[pixel * value.size() + c] += value[c];
    }
  }
  for (double& sum : sums) sum /= static_cast<double>(spec.spp);
  return sums;
}

/// Within 1e-5 of each value (the evaluator's own tests derive that); floats below 1e-38 are gone, which a
/// share of 1e-30 of the channel's mean allows for.
void expect_equal(const RenderResult& result, const std::vector<double>& expected) {
  ASSERT_EQ(result.mean.size(), expected.size());
  double largest = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double floor = 1e-30 * result.image_mean[i % result.channels];
    largest = std::max(largest, std::abs(result.mean[i] - expected[i]) / (expected[i] + floor));
  }
  EXPECT_LT(largest, 1e-5);
}

void expect_film_equals_paths(RenderSpec spec) {
  spec.isa = to_string(lowest_isa());
  for (const WavelengthMode mode : {WavelengthMode::kShared, WavelengthMode::kPerPath}) {
    for (const SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
      spec.sampling.wavelengths = mode;
      spec.sampling.sampler = sampler;
      const RenderResult result = render(spec);
      const std::vector<double> expected = reference_means(spec, result);
      expect_equal(result, expected);
      EXPECT_GT(result.image_mean[0], 0);
    }
  }
}

RenderSpec small_spec(const std::string& parts) {
  RenderSpec spec = room_spec({kSize, kSize});
  spec.xml = scene(6, camera_text({kSize, kSize}) + parts);
  spec.bands = "500:600:9";
  return spec;
}

/// Without its rough plastic, whose tables the backend adds to its own copy of the scene.
std::string room_without_rough_plastic() {
  std::string parts = room_parts();
  const std::string from = rough_plastic();
  return parts.replace(parts.find(from), from.size(), bsdf("plastic"));
}

TEST(SavedPaths, SumToTheFilm) {
  RenderSpec spec = small_spec(room_without_rough_plastic());
  expect_film_equals_paths(spec);
  spec.bands = "500-540, 520-560, 599-600";  // overlapping: the response counts them once
  expect_film_equals_paths(spec);
}

TEST(SavedPaths, SumToTheFilmWithDispersion) {
  const TemporaryFolder folder;
  folder.write("flint.txt", "500 1.80\n550 1.79\n600 1.78\n");
  const auto ball = [](const char* type, double x) {
    return shape("sphere", number("point", "center", point(x, -0.2, 1)) + real("radius", 0.35) +
                               bsdf(type, text("int_material", "flint.txt")));
  };
  RenderSpec spec =
      small_spec(room_without_rough_plastic() + ball("dielectric", 0.4) + ball("roughdielectric", -0.4));
  spec.directory = folder.path();
  expect_film_equals_paths(spec);
}

/// Image means of all modes, by t-tests of their differences (15 degrees of freedom, conservative; seeds
/// differ). Family-wise error rate 1e-4 over 3 x 5 comparisons, critical |t| 6.7; a difference of 9 standard
/// errors, 9 % of the mean, is detected with probability 0.97.
TEST(Modes, AgreeInTheMean) {
  RenderSpec spec = room_spec({24, 24});
  spec.spp = 512;
  spec.sampling.replicates = 16;
  std::vector<RenderResult> results;
  for (const WavelengthMode mode : {WavelengthMode::kShared, WavelengthMode::kPerPath}) {
    for (const SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
      ++spec.sampling.seed;
      spec.sampling.wavelengths = mode;
      spec.sampling.sampler = sampler;
      results.push_back(render(spec));
    }
  }
  const double critical = critical_t(1e-4, 15, 16);
  for (std::size_t i = 1; i < results.size(); ++i) {
    for (std::size_t c = 0; c < results[0].channels; ++c) {
      const double variance = results[0].image_variance[c] + results[i].image_variance[c];
      const double mean = results[0].image_mean[c];
      EXPECT_LT(9 * std::sqrt(variance), 0.09 * mean);
      EXPECT_LT(z_score(results[i].image_mean[c], mean, variance), critical)
          << "mode " << i << ", channel " << c;
    }
  }
}

}  // namespace
}  // namespace kiloband::test::test_paths
