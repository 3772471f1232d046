// Random scenes and paths against the double-precision oracle, on every instruction set.
//
// All terms are positive, so errors are relative to each channel's value, the strictest scale. An operation
// rounds by at most 6e-8, a vertex takes at most about 20 of them (Fresnel, texture), a path here has at most
// 8 vertices: 1e-5 is the sum of all worst cases, and what is seen is a tenth of it. A rough transmission has
// the sixth power of components that are three roundings off, four without fused multiply-adds (1.5e-6),
// besides: 2e-6 more for each. Below 1e-30 of the channel's scale floats run out of range.
#include <cmath>

#include "random_scene.hpp"
#include "validation/oracle/evaluate_reference.hpp"

namespace kiloband::test::test_oracle {
namespace {

constexpr double kTolerance = 1e-5;
constexpr double kFloor = 1e-30;
constexpr double kTransmissionTolerance = 2e-6;

/// What the path may deviate, in units of kTolerance.
double allowance(const PathBuffer& paths, std::size_t path) {
  const SavedPath& p = paths.paths[path];
  double allowed = kTolerance;
  for (uint32_t i = p.first; i < p.first + p.count; ++i) {
    const KbPathVertex& v = paths.entries[i];
    if ((v.head & KB_VERTEX_KIND_MASK) == KB_KIND_ROUGH_TRANSMISSION) allowed += kTransmissionTolerance;
    i += (static_cast<uint32_t>(__builtin_popcount(v.head & KB_VERTEX_TEX_MASK)) + 1) / 2;
  }
  return allowed / kTolerance;
}

/// Largest relative error over paths, channels and derived channels, over what the path is allowed.
double largest_error(const FlatScene& scene, const DerivedChannels& derived, const PathBuffer& paths, Isa isa,
                     double mu, bool shared) {
  const Evaluator layout(scene, derived, isa);
  const std::vector<float> sums = evaluate(scene, derived, paths, isa, mu, shared);
  const std::size_t channels = scene.channels.size();
  double largest = 0;
  for (std::size_t p = 0; p < paths.paths.size(); ++p) {
    const std::vector<double> expected = evaluate_path_reference(scene, derived, paths, p, mu);
    const float* film = &sums[paths.paths[p].pixel * layout.stride()];
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const bool is_derived = i >= channels;
      const double scale = is_derived ? layout.derived_scale(i - channels) : scene.channel_scale[i];
      const double value = film[is_derived ? layout.derived_offset() + i - channels : i] * scale;
      const double error =
          std::abs(value - expected[i]) / (expected[i] + kFloor * scale) / allowance(paths, p);
      if (!(error <= largest)) largest = error;
    }
  }
  return largest;
}

class Oracle : public EachIsa {};

TEST_P(Oracle, RandomPathsAgree) {
  std::mt19937 random(7);
  std::size_t lit = 0;
  for (std::size_t count : {1u, 7u, 63u, 64u, 65u, 100u, 1000u}) {
    for (Layout layout : {Layout::kRegular, Layout::kOverlapping, Layout::kNarrow, Layout::kInfrared}) {
      const FlatScene scene = make_scene(make_channels(count, layout, random), random);
      const PathBuffer paths = make_paths(scene, count == 1000 ? 6 : 40, random);
      const DerivedChannels derived = make_responses();
      for (double mu : {0.0, 0.37109375, 0.9375}) {
        for (bool shared : {true, false}) {
          EXPECT_LT(largest_error(scene, derived, paths, GetParam(), mu, shared), kTolerance)
              << count << " channels, layout " << static_cast<int>(layout) << ", mu " << mu
              << (shared ? " shared" : " per path");
        }
      }
      for (double value : evaluate_path_reference(scene, derived, paths, 0, 0.5)) lit += value > 0;
    }
  }
  EXPECT_GT(lit, 1000u);  // the comparison is not one of zeros
}

/// Emissivities at temperatures of their own, from 200 to 5400 K and 0 K.
TEST_P(Oracle, RandomTemperaturesAgree) {
  std::mt19937 random(17);
  for (Layout layout : {Layout::kRegular, Layout::kInfrared}) {
    FlatScene scene = make_scene(make_channels(100, layout, random), random);
    scene.features.temperature_field = true;
    const PathBuffer paths = make_paths(scene, 60, random);
    for (const bool shared : {true, false})
      EXPECT_LT(largest_error(scene, {}, paths, GetParam(), 0.37109375, shared), kTolerance);
  }
}

TEST_P(Oracle, LongPath) {
  // 1000 vertices on one material with a throughput around 1. The rounding of a float row (3e-8 in the mean,
  // 6e-8 at most) is the same at every vertex and adds up to at most 6e-5; the other roundings are a random
  // walk, sqrt(3000) * 3e-8 = 2e-6.
  constexpr double kLongTolerance = 7e-5;
  std::mt19937 random(11);
  FlatScene scene = make_scene(make_channels(100, Layout::kRegular, random), random);
  std::uniform_real_distribution<double> narrow(0.495, 0.505);
  for (double& value : scene.spectra[0].table.values)
    value = narrow(random);  // row 0 is continued beyond its ends
  PathBuffer paths;
  paths.paths.push_back({0, 1000, 0});
  KbPathVertex vertex{};
  vertex.head = KB_KIND_SCALED | KB_VERTEX_NEE | KB_VERTEX_SCATTER;
  vertex.nee_row = 8;
  vertex.nee0 = 0.7f;
  vertex.scatter0 = 2;
  paths.entries.assign(1000, vertex);
  EXPECT_LT(largest_error(scene, {}, paths, GetParam(), 0.3, true), kLongTolerance);
  // The same through rows of its own.
  for (KbPathVertex& v : paths.entries) v.head = (v.head & ~KB_VERTEX_KIND_MASK) | KB_KIND_TWO_TERM;
  EXPECT_LT(largest_error(scene, {}, paths, GetParam(), 0.3, true), kLongTolerance);
}

INSTANTIATE_TEST_SUITE_P(, Oracle, testing::ValuesIn(available_isas()), isa_name);

}  // namespace
}  // namespace kiloband::test::test_oracle
