// Evaluation kernels on an OpenCL device against the double-precision oracle and against the CPU evaluator.
//
// All terms of the random paths are positive. An error is relative to the largest value that the channel has
// over mu (tables are as accurate as the largest value in a channel). Rounding: 6e-8 per operation, about 20
// operations per vertex, 8 vertices: 1e-5 is the sum of worst cases. Seen: 1.6e-6 at most, 9e-6 with seven
// narrow channels. Nearer to a critical angle than these paths come, a reflectance magnifies the rounding of
// its index row without bound, as 1 / sqrt(distance).
#include "device_scene.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test::device_evaluator_test {
namespace {

constexpr double kTolerance = 1e-5;
/// Between methods: the same values, sums of samples rounded differently.
constexpr double kRounding = 2e-6;

struct Case {
  std::size_t channels;
  Layout layout;
};

DerivedChannels straight_responses() {
  DerivedChannels derived;
  derived.names = {"rising", "falling"};
  derived.responses = {table(300, 20000, {0.1, 1}, true), table(300, 20000, {1, 0.2}, true)};
  return derived;
}

/// temperatures: some emission is an emissivity with a temperature of its own.
FlatScene with_temperatures(FlatScene scene, bool temperatures) {
  scene.features.temperature_field = temperatures;
  return scene;
}

/// Scene, paths and expected means for a build.
struct Workload {
  Workload(const Case& c, const DerivedChannels& responses, bool per_path, std::mt19937& random,
           bool temperatures = false)
      : derived(responses),
        scene(with_temperatures(make_device_scene(c.channels, c.layout, random), temperatures)),
        tables(opencl::make_channel_tables(scene, derived)),
        paths(make_paths(scene, c.channels == 1000 ? 8 : 40, random)),
        round(make_round(paths, c.channels == 1000 ? 6 : 12, c.channels == 1000 ? 2 : 5, random)),
        expected(reference(scene, derived, tables, paths, round, per_path)) {}

  DerivedChannels derived;
  FlatScene scene;
  opencl::ChannelTables tables;
  PathBuffer paths;
  RoundOfPaths round;
  Expected expected;
};

std::vector<Case> cases() {
  return {{1, Layout::kRegular},       {7, Layout::kRegular},    {100, Layout::kRegular},
          {100, Layout::kOverlapping}, {100, Layout::kInfrared}, {1000, Layout::kRegular},
          {7, Layout::kNarrow}};
}

class DeviceEvaluation : public testing::TestWithParam<EvaluatorBuild> {};

/// Planck's law at any temperature from 200 to 5400 K, in float.
TEST_P(DeviceEvaluation, RandomTemperaturesAgreeWithTheOracle) {
  EvaluatorProgram program(GetParam());
  std::mt19937 random(17);
  for (const Case& c : {Case{100, Layout::kRegular}, {100, Layout::kInfrared}, {7, Layout::kNarrow}}) {
    const Workload w(c, straight_responses(), GetParam().per_path, random, true);
    DeviceEvaluator device(program, w.scene, w.tables, w.round.pixels);
    device.load(w.paths, w.round);
    device.batch(3, 5);
    EXPECT_LT(largest_error(device.means(), w.expected), kTolerance) << c.channels;
  }
}

TEST_P(DeviceEvaluation, RandomPathsAgreeWithTheOracle) {
  EvaluatorProgram program(GetParam());
  std::mt19937 random(7);
  for (const Case& c : cases()) {
    const Workload w(c, straight_responses(), GetParam().per_path, random);
    const std::string name =
        std::to_string(c.channels) + " channels, layout " + std::to_string(static_cast<int>(c.layout));
    DeviceEvaluator device(program, w.scene, w.tables, w.round.pixels);
    device.load(w.paths, w.round);
    device.batch(3, 5);
    const std::vector<float> batch = device.means();
    EXPECT_LT(largest_error(batch, w.expected), kTolerance) << name;
    EXPECT_EQ(device.counts(), w.expected.counts) << name;
    device.clear();
    device.path(4);
    EXPECT_EQ(device.counts(), w.expected.counts) << name;
    EXPECT_LT(largest_difference(device.means(), batch, w.expected), kRounding) << "path, " << name;
    device.clear();
    device.pt(w.paths, w.round.pixels / 2, 2);
    EXPECT_EQ(device.counts(), w.expected.counts) << name;
    EXPECT_LT(largest_difference(device.means(), batch, w.expected), kRounding) << "pt, " << name;
  }
}

/// Where the reconstruction filter is negative: the same numbers with the other sign, bit by bit.
TEST_P(DeviceEvaluation, NegativePaths) {
  EvaluatorProgram program(GetParam());
  std::mt19937 random(18);
  Workload w({100, Layout::kRegular}, straight_responses(), GetParam().per_path, random);
  DeviceEvaluator device(program, w.scene, w.tables, w.round.pixels);
  const auto means_of_methods = [&] {
    std::vector<float> means;
    const auto take = [&] {
      const std::vector<float> more = device.means();
      means.insert(means.end(), more.begin(), more.end());
      device.clear();
    };
    device.load(w.paths, w.round);
    device.batch(3, 5);
    take();
    device.path(4);
    take();
    device.pt(w.paths, w.round.pixels / 2, 2);
    take();
    return means;
  };
  const std::vector<float> positive = means_of_methods();
  for (const SavedPath& path : w.paths.paths) w.paths.entries[path.first].head |= KB_VERTEX_NEGATIVE;
  std::vector<float> negative = means_of_methods();
  EXPECT_GT(*std::ranges::max_element(positive), 0);
  for (float& mean : negative) mean = -mean;
  EXPECT_EQ(negative, positive);
}

/// The widths that devices take (evaluation_shape) with one and several vectors, side by side and not; thorough: width 8, which none
/// does, and the others' other forms.
std::vector<EvaluatorBuild> builds() {
  return with_others_if_thorough<EvaluatorBuild>(
      {{16, 1, false, 2},
       {16, 4, true, 2, false, 5},
       {16, 2, false, 2, false, 16},
       {4, 2, true, 2, true},
       {2, 3, false, 2},
       {1, 1, true, 2}},
      {{8, 2, false, 2}, {8, 1, true, 2}, {4, 1, true, 2}, {1, 2, false, 2}});
}

INSTANTIATE_TEST_SUITE_P(, DeviceEvaluation, testing::ValuesIn(builds()), build_name);

/// The same sums, on the CPU backend's evaluator, path by path.
std::vector<float> cpu_means(const Workload& w, bool per_path) {
  const Evaluator layout(w.scene, w.derived, Isa::kAuto);
  const std::size_t channels = w.scene.channels.size(), columns = channels + w.derived.responses.size();
  std::vector<double> sums(w.round.pixels * columns, 0.0);
  for (uint32_t job = 0; job < w.round.path.size(); ++job) {
    if (w.round.path[job] >= RoundOfPaths::kEmpty) continue;
    const uint32_t pixel = job % w.round.pixels, sample = job / w.round.pixels;
    const float mu = per_path ? per_path_mu(w.round, pixel, sample)
                              : w.round.mu[w.round.block[pixel] * w.round.samples + sample];
    PathBuffer one;
    one.entries = w.paths.entries;
    one.paths = {w.paths.paths[w.round.path[job]]};
    one.paths[0].pixel = 0;
    const std::vector<float> row = evaluate(w.scene, w.derived, one, Isa::kAuto, mu, true);
    for (std::size_t i = 0; i < columns; ++i)
      sums[pixel * columns + i] += row[i < channels ? i : layout.derived_offset() + i - channels];
  }
  std::vector<float> means;
  for (std::size_t i = 0; i < sums.size(); ++i)
    means.push_back(static_cast<float>(sums[i] / std::max(1u, w.expected.counts[i / columns])));
  return means;
}

TEST(DeviceEvaluator, AgreesWithTheCpuEvaluator) {
  std::mt19937 random(8);
  for (bool per_path : {false, true}) {
    EvaluatorProgram program({16, 4, per_path, 2});
    for (const Case& c : cases()) {
      const Workload w(c, straight_responses(), per_path, random);
      DeviceEvaluator device(program, w.scene, w.tables, w.round.pixels);
      device.load(w.paths, w.round);
      device.batch(2, 3);
      EXPECT_LT(largest_difference(device.means(), cpu_means(w, per_path), w.expected), kTolerance)
          << c.channels;
    }
  }
}

TEST(DeviceEvaluator, ResponsesThatAreNarrowContinuedOrElsewhere) {
  // Equal channels of 4 nm: the responses' kinks meet nodes.
  std::mt19937 random(9);
  for (bool per_path : {false, true}) {
    EvaluatorProgram program({16, 2, per_path, 4});
    const Workload w({100, Layout::kRegular}, make_responses(), per_path, random);
    DeviceEvaluator device(program, w.scene, w.tables, w.round.pixels);
    device.load(w.paths, w.round);
    device.batch(2, 3);
    EXPECT_LT(largest_error(device.means(), w.expected), kTolerance);
    for (uint32_t p = 0; p < w.round.pixels; ++p) EXPECT_EQ(device.means()[p * 104 + 103], 0.0f);
  }
}

TEST(DeviceEvaluator, GroupsAndLocalSizesDoNotChangeChannels) {
  std::mt19937 random(10);
  EvaluatorProgram program({8, 2, false, 2});
  const Workload w({100, Layout::kRegular}, straight_responses(), false, random);
  DeviceEvaluator device(program, w.scene, w.tables, w.round.pixels);
  device.load(w.paths, w.round);
  device.batch(1, 1);
  const std::vector<float> expected = device.means();
  for (uint32_t local : {2u, 7u, 16u}) {
    for (uint32_t groups : {1u, 12u, 40u}) {
      device.clear();
      device.batch(local, groups);
      const std::vector<float> means = device.means();
      for (std::size_t i = 0; i < means.size(); ++i) {
        if (i % 102 < 100) {
          ASSERT_EQ(means[i], expected[i]) << local << " " << groups << " " << i;
        }
      }
    }
  }
}

TEST(DeviceEvaluator, AMillionEqualSamplesLoseNothing) {
  // 20 rounds of 50,000 samples of one path. A plain float sum would be off by 1e-3 or worse.
  std::mt19937 random(11);
  EvaluatorProgram program({16, 1, false, 2});
  Workload w({16, Layout::kRegular}, straight_responses(), false, random);
  w.round.pixels = w.round.blocks = 1;
  w.round.samples = 50000;
  w.round.path.assign(w.round.samples, 3);
  w.round.block.assign(1, 0);
  // One table for all samples would do; the kernel wants one each: few rows, so that is small.
  w.round.mu.assign(w.round.samples, 0.25f);
  const Expected once = reference(
      w.scene, w.derived, w.tables, w.paths,
      [&] {
        RoundOfPaths one = w.round;
        one.samples = 1;
        one.path.resize(1);
        return one;
      }(),
      false);
  DeviceEvaluator device(program, w.scene, w.tables, 1);
  RoundOfPaths one = w.round;
  one.samples = 1;
  one.path.resize(1);
  one.mu.resize(1);
  device.load(w.paths, one);
  device.batch(1, 1);
  const std::vector<float> single = device.means();
  device.clear();
  device.load(w.paths, w.round);
  for (int i = 0; i < 20; ++i) device.batch(1, 1);
  EXPECT_EQ(device.counts(), std::vector<uint32_t>{1000000});
  const std::vector<float> means = device.means();
  for (std::size_t i = 0; i < means.size(); ++i)
    EXPECT_NEAR(means[i], single[i], (i < 16 ? 1e-6 : 1e-5) * single[i]) << i;
  EXPECT_LT(largest_error(means, once), kTolerance);
}

/// Paths of diffuse surfaces only.
PathBuffer plain_paths(const FlatScene& scene, std::mt19937& random) {
  PathBuffer paths = make_paths(scene, 40, random), plain;
  for (const SavedPath& path : paths.paths) {
    const uint32_t first = static_cast<uint32_t>(plain.entries.size());
    for (uint32_t i = 0; i < path.count;) {
      KbPathVertex v = paths.entries[path.first + i];
      i += entries_of(v);
      if ((v.head & KB_VERTEX_TEX_MASK) || (v.head & KB_VERTEX_KIND_MASK) != KB_KIND_SCALED) continue;
      v.head &= ~KB_VERTEX_DEGRADE;
      plain.entries.push_back(v);
    }
    const uint32_t count = static_cast<uint32_t>(plain.entries.size()) - first;
    plain.paths.push_back({first, count, path.pixel});
  }
  return plain;
}

TEST(DeviceEvaluator, SpecialisedKernelsComputeTheSameBits) {
  std::mt19937 random(12);
  Workload w({100, Layout::kRegular}, {}, false, random);
  const std::pair<std::string, uint32_t> features[] = {
      {"-DKB_HAS_DIFFUSE=1", 1u << KB_KIND_SCALED},
      {"-DKB_HAS_PLASTIC=1", 1u << KB_KIND_SCALED | 1u << KB_KIND_TWO_TERM | 1u << KB_KIND_NONLINEAR},
      {"-DKB_HAS_ROUGH_CONDUCTOR=1", 1u << KB_KIND_SCALED | 1u << KB_KIND_CONDUCTOR},
      {"-DKB_HAS_DISPERSION=1", 1u << KB_KIND_SCALED | 1u << KB_KIND_DISPERSIVE},
      {"-DKB_HAS_BITMAP=1 -DKB_HAS_SPECTRAL_TEXTURE=1", 1u << KB_KIND_SCALED},
  };
  const PathBuffer many = make_paths(w.scene, 400, random);
  EvaluatorProgram general({16, 2, false, 0});
  for (const auto& [macro, kinds] : features) {
    // Paths whose vertices are all of the build's kinds;
    // with a feature's macro alone the others are compiled out.
    PathBuffer some;
    some.entries = many.entries;
    const bool textures = macro.find("TEXTURE") != std::string::npos;
    for (const SavedPath& path : many.paths) {
      bool fits = true;
      for (uint32_t i = 0; i < path.count; i += entries_of(many.entries[path.first + i])) {
        const KbPathVertex& v = many.entries[path.first + i];
        fits &= (textures || !(v.head & KB_VERTEX_TEX_MASK)) && (kinds >> (v.head & KB_VERTEX_KIND_MASK) & 1);
        fits &= !(v.head & KB_VERTEX_DEGRADE) || macro == "-DKB_HAS_DISPERSION=1";
      }
      if (fits) some.paths.push_back(path);
    }
    if (macro == "-DKB_HAS_DIFFUSE=1") some = plain_paths(w.scene, random);
    ASSERT_GT(some.paths.size(), 0u) << macro;
    const RoundOfPaths round = make_round(some, 12, 5, random);
    EvaluatorProgram special({16, 2, false, 0, false, 1, "-DKB_SPECIALISED " + macro});
    std::vector<std::vector<float>> means;
    for (EvaluatorProgram* program : {&general, &special}) {
      DeviceEvaluator device(*program, w.scene, w.tables, round.pixels);
      device.load(some, round);
      device.batch(2, 3);
      means.push_back(device.means());
      device.clear();
      device.pt(some, 6, 2);
      means.push_back(device.means());
    }
    EXPECT_EQ(means[0], means[2]) << macro;
    EXPECT_EQ(means[1], means[3]) << macro;
    EXPECT_GT(*std::ranges::max_element(means[0]), 0.0f) << macro;
  }
}

}  // namespace
}  // namespace kiloband::test::device_evaluator_test
