// Several devices: two halves of an OpenCL device give the bits of the whole; blocks that the CPU backend and a device
// rendered together have the bits of the one or the other.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>

#include "backend_images.hpp"
#include "render/devices/device_group.hpp"
#include "render/devices/staged_sums.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/film_delivery.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test {
namespace {

constexpr uint32_t kReplicates = 2, kSamples = 3;

bool is_one_unit() {
  return opencl::select_device("0").compute_units < 2;
}

class SeveralDevices : public testing::Test {
 protected:
  void SetUp() override {
    if (is_one_unit()) GTEST_SKIP() << "a device of one compute unit has no parts";
  }

  /// A scene of the zoo with 75 x 50 pixels.
  FlatScene large(const std::string& name) const {
    ReadOptions options;
    options.film_size = {75, 50};
    const SceneDescription description =
        read_scene_text(zoo_scene(name).xml, name + ".xml", folder_.path(), options);
    return *compile_scene(description, {parse_channels(kZooBands), parse_channels(kZooBands), {}});
  }

  static SamplingSettings settings(SamplerType sampler) {
    const bool sobol = sampler == SamplerType::kSobol;
    return {sobol ? WavelengthMode::kShared : WavelengthMode::kPerPath, sampler, 9, kReplicates};
  }

  static std::vector<std::unique_ptr<Backend>> halves(const std::string& method, const FlatScene& scene,
                                                      const SamplingSettings& sampling,
                                                      const DerivedChannels& derived = {}) {
    opencl::Options options;
    options.device = "0/2";
    options.specialised = false;
    options.method = opencl::find_method(method.substr(method.find(':') + 1));
    return opencl::make_backends(std::make_shared<const FlatScene>(scene), derived, sampling, options);
  }

  const ZooFolder folder_;
  const PixelRect rect_{3, 5, 70, 41};  // six blocks, most of them clipped
};

void expect_same_bits(const Image& a, const Image& b, const std::string& what) {
  ASSERT_EQ(a.means.size(), b.means.size());
  EXPECT_EQ(a.samples, b.samples) << what;
  EXPECT_EQ(std::memcmp(a.means.data(), b.means.data(), a.means.size() * sizeof(float)), 0) << what;
}

/// Without KILOBAND_THOROUGH the independent sampler in one scene.
TEST_F(SeveralDevices, OfOneKindGiveTheBitsOfOne) {
  for (const std::string name : {"diffuse_room", "spectral_pictures", "gases"}) {
    const FlatScene scene = large(name);
    for (const std::string& method : kOpenclMethods) {
      for (const SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
        if (sampler == SamplerType::kIndependent && name != "diffuse_room" && !thorough()) continue;
        const std::string what = name + ", " + method;
        const auto single = make_zoo_backend(method, scene, {}, settings(sampler));
        const auto group = make_device_group(halves(method, scene, settings(sampler)), {});
        EXPECT_EQ(group->sum_rule(), single->sum_rule()) << what;
        const Image expected = render_part(*single, rect_, kReplicates, kSamples);
        expect_same_bits(render_part(*group, rect_, kReplicates, kSamples), expected, what);
        const BackendStatistics done = group->statistics();
        EXPECT_EQ(done.paths, single->statistics().paths) << what;
        EXPECT_EQ(done.rays, single->statistics().rays) << what;
        for (const DeviceShare& share : done.devices) EXPECT_GT(share.paths, 0u) << what;
      }
    }
  }
}

/// All means of a film that holds sums, which come in parts of several sizes.
std::vector<float> in_parts(Backend& backend, const PixelRect& rect) {
  FilmOptions options{backend.film_scale().size(), kReplicates, true, true};
  options.sums = backend.sum_rule();
  SpectralFilm film(rect, options);
  const std::vector<uint32_t> blocks = film.all_blocks();
  const std::atomic<bool> stop{false};
  for (uint32_t r = 0; r < kReplicates; ++r) {
    for (const auto& [first, count] : {std::pair{0u, 1u}, {1u, 2u}, {3u, 16u}, {19u, 4u}})
      backend.render(film, {r, first, count}, blocks, stop, {});
  }
  std::vector<float> means, mean(options.channels);
  for (uint32_t r = 0; r < kReplicates; ++r) {
    for (std::size_t p = 0; p < rect.pixels(); ++p) {
      film.replicate_mean(r, p, mean);
      means.insert(means.end(), mean.begin(), mean.end());
      EXPECT_EQ(film.replicate_samples(r, p), 23u);
    }
  }
  return means;
}

TEST_F(SeveralDevices, OfOneKindGiveTheBitsOfOneInParts) {
  const FlatScene scene = large("diffuse_room");
  const DerivedChannels derived = zoo_responses(scene.channels);
  for (const std::string& method : kOpenclMethods) {
    const SamplingSettings sampling = settings(SamplerType::kSobol);
    const auto single = make_zoo_backend(method, scene, derived, sampling);
    const auto group = make_device_group(halves(method, scene, sampling, derived), {});
    const std::vector<float> expected = in_parts(*single, rect_), got = in_parts(*group, rect_);
    ASSERT_EQ(expected.size(), got.size());
    EXPECT_EQ(std::memcmp(expected.data(), got.data(), got.size() * sizeof(float)), 0) << method;
  }
}

/// The CPU backend with a thread, and half of the OpenCL device.
std::unique_ptr<Backend> mixed(std::vector<std::unique_ptr<Backend>> devices, const FlatScene& scene,
                               const SamplingSettings& sampling, const DerivedChannels& derived = {}) {
  devices.pop_back();
  devices.push_back(
      cpu::make_backend(std::make_shared<const FlatScene>(scene), derived, sampling, {cpu::Isa::kAuto, 1}));
  return make_device_group(std::move(devices), {});
}

/// Largest difference of a block's values from another image's, relative to the pixel's largest channel.
double difference_in(const PixelRect& block, const PixelRect& rect, std::size_t channels,
                     const std::vector<float>& a, const std::vector<float>& b) {
  double largest = 0;
  for (uint32_t y = 0; y < block.height; ++y) {
    for (uint32_t x = 0; x < block.width; ++x) {
      const std::size_t pixel = std::size_t{block.y0 + y - rect.y0} * rect.width + block.x0 + x - rect.x0;
      const float* const value = &a[pixel * channels];
      const double scale = *std::max_element(value, value + channels);
      for (std::size_t c = 0; c < channels; ++c) {
        const double difference = std::abs(double{value[c]} - b[pixel * channels + c]);
        if (difference > 0) largest = std::max(largest, difference / scale);
      }
    }
  }
  return largest;
}

/// Every block of every replicate is one backend's or the other's, to within `tolerance`.
void expect_blocks_of_either(const PixelRect& rect, std::size_t channels, const std::vector<float>& got,
                             const std::vector<float>& one, const std::vector<float>& other,
                             double tolerance) {
  const std::size_t values = rect.pixels() * channels;
  for (uint32_t r = 0; r < kReplicates; ++r) {
    const auto replicate = [&](const std::vector<float>& all) {
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(r * values);
      return std::vector<float>(first, first + static_cast<std::ptrdiff_t>(values));
    };
    const std::vector<float> mine = replicate(got), a = replicate(one), b = replicate(other);
    for (const PixelRect& block : cut_into_blocks(rect)) {
      const double difference = std::min(difference_in(block, rect, channels, mine, a),
                                         difference_in(block, rect, channels, mine, b));
      EXPECT_LE(difference, tolerance) << "block at " << block.x0 << ", " << block.y0;
    }
  }
}

TEST_F(SeveralDevices, OfTwoKindsGiveTheBitsOfTheOneOrTheOther) {
  const FlatScene scene = large("gases");
  const std::string method = "opencl:dpept-batch";
  const SamplingSettings sampling = settings(SamplerType::kSobol);
  const Image cpu = render_part(*make_zoo_backend("cpu", scene, {}, sampling), rect_, kReplicates, kSamples);
  const Image opencl =
      render_part(*make_zoo_backend(method, scene, {}, sampling), rect_, kReplicates, kSamples);
  const auto both = mixed(halves(method, scene, sampling), scene, sampling);
  const Image got = render_part(*both, rect_, kReplicates, kSamples);
  EXPECT_EQ(got.samples, cpu.samples);
  expect_blocks_of_either(rect_, scene.channels.size(), got.means, cpu.means, opencl.means, 0);
  EXPECT_EQ(both->info().name, "cpu+opencl");
  for (const DeviceShare& share : both->statistics().devices) EXPECT_GT(share.paths, 0u);
}

/// What is added in parts may be of the one in one part, of the other in the next: their paths are the same but for a
/// few that part (parity_test.cpp), so the images' means agree. Here, of 0.1 % of 132020 paths that differ by as much as
/// the mean itself at random: 3e-4 in the image's mean at 3 standard deviations.
TEST_F(SeveralDevices, OfTwoKindsGiveTheSameImageInParts) {
  const FlatScene scene = large("diffuse_room");
  const DerivedChannels derived = zoo_responses(scene.channels);
  const SamplingSettings sampling = settings(SamplerType::kSobol);
  const std::string method = "opencl:dpept-batch";
  const auto both = mixed(halves(method, scene, sampling, derived), scene, sampling, derived);
  EXPECT_EQ(both->sum_rule(), kStagedRule);
  const std::vector<float> got = in_parts(*both, rect_);
  const std::vector<float> cpu = in_parts(*make_zoo_backend("cpu", scene, derived, sampling), rect_);
  ASSERT_EQ(got.size(), cpu.size());
  const auto sum = [](const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
  };
  EXPECT_NEAR(sum(got) / sum(cpu), 1, 3e-4);
  std::size_t far = 0;
  for (std::size_t i = 0; i < got.size(); ++i)
    far += std::abs(got[i] - cpu[i]) > 1e-4f * std::abs(cpu[i]) + 1e-6f;
  // A pixel has 23 samples, of which 0.1 % part: 2.3 % of the pixels.
  EXPECT_LT(static_cast<double>(far), 0.04 * static_cast<double>(got.size()));
}

TEST(FilmDelivery, LeavesNothingOfABlockThatIsNotComplete) {
  constexpr std::size_t kChannels = 2;
  FilmOptions options{kChannels, 1, false, true};
  options.sums = SumRule{SumRule::Kind::kCompensated, 16, 16, 1};
  SpectralFilm film({0, 0, 4, 2}, options);
  const SampleRange range{0, 0, 3};
  const std::vector<uint32_t> blocks{0};
  const auto group = [&](std::size_t number, float value) {
    const std::vector<float> values(number * kChannels, value), none(number * kChannels);  // in a first chunk
    opencl::GroupResult result;
    result.sums = {values, none, none, std::vector<uint32_t>(number, 3)};
    result.attempted = 3;
    return result;
  };
  opencl::FilmDelivery delivery(film, range, blocks, kChannels);
  delivery.add(group(5, 1));
  EXPECT_TRUE(delivery.in_block());
  EXPECT_EQ(delivery.missing(), 3u);
  EXPECT_EQ(film.attempted(0, 0), 0u);
  for (std::size_t p = 0; p < 8; ++p) EXPECT_EQ(film.pixel_sums(0, p).count, 0u);
  delivery.add(group(3, 2));
  EXPECT_FALSE(delivery.in_block());
  EXPECT_EQ(film.attempted(0, 0), 3u);
  for (std::size_t p = 0; p < 8; ++p) {
    EXPECT_EQ(film.pixel_sums(0, p).count, 3u);
    EXPECT_EQ(film.pixel_sums(0, p).open[1], p < 5 ? 1.0f : 2.0f);
  }
}

}  // namespace
}  // namespace kiloband::test
