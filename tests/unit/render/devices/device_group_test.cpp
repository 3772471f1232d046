// Several devices render the image that one of them renders, bit by bit, also where some of them fail.
#include "render/devices/device_group.hpp"

#include <bit>
#include <numeric>

#include "render/checkpoint/fingerprint.hpp"
#include "render/devices/staged_sums.hpp"
#include "tests/unit/render/devices/faulty_backend.hpp"
#include "tests/unit/render/session_fixture.hpp"

namespace kiloband {
namespace {

using test::Fault, test::FaultyBackend;

class DeviceGroupTest : public SessionTest {
 protected:
  std::unique_ptr<Backend> one(SamplerType sampler = SamplerType::kSobol) const {
    SamplingSettings sampling;
    sampling.seed = 3;
    sampling.sampler = sampler;
    sampling.wavelengths =
        sampler == SamplerType::kSobol ? WavelengthMode::kShared : WavelengthMode::kPerPath;
    sampling.replicates = session_replicates(settings_);
    return cpu::make_backend(std::make_shared<const FlatScene>(scene_), {}, sampling, {cpu::Isa::kAuto, 1});
  }
  std::unique_ptr<FaultyBackend> faulty(const Fault& fault, const std::string& name = "faulty") const {
    return std::make_unique<FaultyBackend>(one(), fault, name);
  }
  /// One with a fault, and one that renders nothing before: the image's nine blocks are at least four jobs for the first.
  std::unique_ptr<Backend> failing(const Fault& fault) {
    auto first = faulty(fault), second = faulty({});
    second->wait_for(*first);
    return group(std::move(first), std::move(second));
  }
  template <class... Some>
  std::unique_ptr<Backend> group(Some... backends) {
    std::vector<std::unique_ptr<Backend>> all;
    (all.push_back(std::move(backends)), ...);
    return make_device_group(std::move(all), messages_.lines());
  }

  /// Cubes of the session's image, whole; also its report.
  test::Cube image(Backend& backend, const std::string& name = "image.hdr") {
    report_ = run(backend, name);
    return read(name);
  }
  void expect_image(Backend& backend, const test::Cube& expected) {
    const test::Cube got = image(backend);
    expect_same(expected.mean, got.mean, 0);
    expect_same(expected.variance, got.variance, 0);
  }

  test::Messages messages_;
  RenderReport report_;
};

TEST_F(DeviceGroupTest, RendersTheBitsOfOne) {
  for (const SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
    for (const bool in_parts : {false, true}) {
      settings_.stop.samples_per_pixel = in_parts ? 320 : 40;  // 20 samples in each of 16 replicates
      const test::Cube expected = image(*one(sampler));
      const double mean = report_.image_mean.front();
      expect_image(*group(one(sampler), one(sampler)), expected);
      EXPECT_EQ(report_.image_mean.front(), mean);
      expect_image(*group(one(sampler), one(sampler), one(sampler)), expected);
    }
  }
  EXPECT_TRUE(messages_.texts.empty()) << messages_.texts.front();
}

TEST_F(DeviceGroupTest, RendersTheBitsOfOneInStripsAndInACrop) {
  settings_.memory_budget_bytes = 100000;
  scene_.film.crop_x = 5, scene_.film.crop_y = 9, scene_.film.crop_width = 61, scene_.film.crop_height = 60;
  const test::Cube expected = image(*one());
  ASSERT_TRUE(report_.streamed);
  expect_image(*group(one(), one()), expected);
}

/// However late a device's thread is given a core, it finds blocks left: a first job is a quarter of a share.
TEST_F(DeviceGroupTest, HasEveryDeviceAtWork) {
  const auto all = std::make_shared<std::latch>(2);
  auto first = faulty({}), second = faulty({});
  first->meet_at(all), second->meet_at(all);
  const auto both = group(std::move(first), std::move(second));
  image(*both);
  const BackendStatistics done = both->statistics();
  ASSERT_EQ(done.devices.size(), 2u);
  EXPECT_EQ(done.paths, std::size_t{kSize} * kSize * 40);
  EXPECT_EQ(done.devices[0].paths + done.devices[1].paths, done.paths);
  for (const DeviceShare& share : done.devices) {
    EXPECT_GT(share.paths, 0u);
    EXPECT_GT(share.busy_seconds, 0);
    EXPECT_EQ(share.failure, "");
  }
}

TEST_F(DeviceGroupTest, DescribesDevicesOfOneKindLikeOneOfThem) {
  const auto single = one();
  const auto both = group(one(), one());
  EXPECT_EQ(arithmetic_of(*both), arithmetic_of(*single));
  EXPECT_EQ(both->info().name, single->info().name);
  EXPECT_EQ(both->info().device, single->info().device);
  EXPECT_EQ(both->sum_rule(), single->sum_rule());
  EXPECT_EQ(both->film_scale(), single->film_scale());
}

/// The first call, a later one; nothing or something delivered before.
TEST_F(DeviceGroupTest, GoesOnWithoutADeviceThatFails) {
  for (const uint64_t samples : {40u, 320u}) {
    settings_.stop.samples_per_pixel = samples;
    const test::Cube expected = image(*one());
    for (const int call : {1, 4}) {
      for (const std::size_t delivered : {0u, 1u}) {
        messages_.texts.clear();
        const auto both = failing({Fault::Kind::kDevice, call, delivered});
        expect_image(*both, expected);
        ASSERT_EQ(messages_.texts.size(), 1u);
        EXPECT_EQ(messages_.texts.front(),
                  "warning: faulty: lost: device 1 of 2 is left out, its work goes to the others");
        EXPECT_EQ(both->statistics().devices[0].failure, "faulty: lost");
      }
    }
  }
}

TEST_F(DeviceGroupTest, CountsEverySampleOnceInTheProgress) {
  settings_.stop.samples_per_pixel = 32;
  for (const std::size_t delivered : {0u, 1u}) {
    const auto both = failing({Fault::Kind::kDevice, 3, delivered});
    uint64_t last = 0;
    run(*both, "image.hdr", false, [&](const Progress& p) {
      EXPECT_GE(p.pixel_samples, last);
      last = p.pixel_samples;
    });
    EXPECT_EQ(last, std::size_t{kSize} * kSize * 32);
  }
}

TEST_F(DeviceGroupTest, EndsWithTheLastErrorWhereAllFail) {
  const auto both =
      group(faulty({Fault::Kind::kDevice, 1}, "first"), faulty({Fault::Kind::kDevice, 3}, "second"));
  const std::string error = test::error_of<DeviceError>([&] { run(*both, "image.hdr"); });
  EXPECT_TRUE(error == "first: lost" || error == "second: lost") << error;
  ASSERT_EQ(messages_.texts.size(), 1u);  // of the one before
  EXPECT_EQ(messages_.texts.front().find(error), std::string::npos) << messages_.texts.front();
  EXPECT_EQ(test::error_of<DeviceError>([&] { run(*both, "image.hdr"); }), error);
}

TEST_F(DeviceGroupTest, DoesNotHideBugs) {
  const auto both = failing({Fault::Kind::kBug, 2});
  EXPECT_EQ(test::error_of<std::logic_error>([&] { run(*both, "image.hdr"); }), "a bug");
}

TEST_F(DeviceGroupTest, AnswersWithADeviceThatWorks) {
  const PixelRect rect{0, 0, 8, 8};
  const auto single = one();
  const auto both = group(faulty({Fault::Kind::kNone, 1, 0, true}), one());
  EXPECT_EQ(both->auxiliary(rect).front().depth, single->auxiliary(rect).front().depth);
  EXPECT_EQ(both->trace(rect, {0, 0, 1}).size(), 64u);
  both->camera_moved();
  EXPECT_EQ(messages_.texts.size(), 1u);
  const auto none = group(faulty({Fault::Kind::kNone, 1, 0, true}));
  EXPECT_EQ(test::error_of<DeviceError>([&] { none->trace(rect, {0, 0, 1}); }), "faulty: lost");
  EXPECT_EQ(test::error_of<DeviceError>([&] { none->camera_moved(); }), "faulty: lost");
}

TEST_F(DeviceGroupTest, IsInterruptedAndResumedOnOneAndTheOtherWayRound) {
  const test::Cube once = image(*one());
  for (const bool group_first : {true, false}) {
    settings_.checkpoint = folder_ / (group_first ? "a.ck" : "b.ck");
    settings_.resume = true;
    const auto make = [&](bool several) { return several ? group(one(), one()) : one(); };
    std::atomic<bool> stop{false};
    const RenderReport part =
        run(*make(group_first), "part.hdr", stop, [&](const Progress& p) { stop = p.fraction > 0.4; });
    EXPECT_TRUE(part.interrupted);
    EXPECT_LT(part.samples_per_pixel, 40u);
    expect_image(*make(!group_first), once);
    EXPECT_GT(report_.resumed_samples, 0u);
  }
}

TEST_F(DeviceGroupTest, EndsAtATargetErrorLikeOne) {
  settings_.stop = {};
  settings_.stop.relative_error = 0.02;
  const test::Cube once = image(*one());
  const uint64_t samples = report_.samples_per_pixel;
  expect_image(*group(one(), faulty({Fault::Kind::kDevice, 5, 1}), one()), once);
  EXPECT_EQ(report_.samples_per_pixel, samples);
  settings_.stop = {};
  settings_.stop.seconds = 0.05;
  image(*group(one(), one()));
  EXPECT_EQ(report_.ended_by, StopReason::kTime);
  EXPECT_GE(report_.samples_per_pixel, 1u);
}

/// Devices that keep sums otherwise: rounding alone, 2e-6, and the same samples.
TEST_F(DeviceGroupTest, OfDifferentRulesRendersTheSameImage) {
  for (const uint64_t samples : {40u, 320u, 1200u}) {  // one at a time at first; beyond a chunk of 64
    settings_.stop.samples_per_pixel = samples;
    const test::Cube expected = image(*one());
    auto other = faulty({Fault::Kind::kDevice, 4, 1});
    auto second = faulty({}), third = faulty({});
    second->wait_for(*other), third->wait_for(*other);
    other->claim_other_rule(), third->claim_other_rule();
    const auto all = group(std::move(other), std::move(second), std::move(third));
    EXPECT_EQ(all->sum_rule(), kStagedRule);
    const test::Cube got = image(*all);
    expect_same(expected.mean, got.mean, 2e-6);
    EXPECT_EQ(report_.samples_per_pixel, samples);
    EXPECT_EQ(messages_.texts.size(), 1u);
    messages_.texts.clear();
  }
}

TEST_F(DeviceGroupTest, OfDifferentRulesIsInterruptedAndResumed) {
  const test::Cube expected = image(*one());
  const auto make = [&] {
    auto other = faulty({});
    other->claim_other_rule();
    return group(std::move(other), one());
  };
  settings_.checkpoint = folder_ / "render.ck";
  settings_.resume = true;
  std::atomic<bool> stop{false};
  run(*make(), "part.hdr", stop, [&](const Progress& p) { stop = p.fraction > 0.4; });
  expect_same(expected.mean, image(*make()).mean, 2e-6);
  EXPECT_GT(report_.resumed_samples, 0u);
}

}  // namespace
}  // namespace kiloband
