// What rounds cost. How often the host waits for the device: at most twice a round, once rounds are known; and the film's pieces.
// How many rounds few pixels take.
#include <gtest/gtest.h>

#include "backend_images.hpp"

namespace kiloband::test::waits_test {
namespace {

struct Work {
  uint64_t rounds = 0, waits = 0;
};

/// What `samples` samples of every pixel take.
Work work_of(Backend& backend, const FlatScene& scene, uint32_t samples) {
  const BackendStatistics before = backend.statistics();
  render_image(backend, scene, 1, samples);
  const BackendStatistics after = backend.statistics();
  return {after.device_rounds - before.device_rounds, after.device_waits - before.device_waits};
}

TEST(DeviceWaits, AtMostTwoPerRound) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(zoo_scene("diffuse_room"), "450:650:4");
  for (const std::string& method : kOpenclMethods) {
    const auto backend =
        make_zoo_backend(method, scene, {}, {WavelengthMode::kShared, SamplerType::kSobol, 5, 1},
                         {.tuning = {.pool_slots = 256}});
    work_of(*backend, scene, 160);  // builds kernels; launches grow, and iterations become known
    const Work few = work_of(*backend, scene, 16 * 10), many = work_of(*backend, scene, 16 * 40);
    const uint64_t rounds = many.rounds - few.rounds, waits = many.waits - few.waits;
    EXPECT_GE(rounds, 30u) << method;
    EXPECT_GE(waits, rounds) << method;  // each is looked at
    EXPECT_LE(waits, 2 * rounds) << method;
    EXPECT_LE(few.waits, 2 * few.rounds + 20) << method << ": and the film";
  }
}

struct Sensor {
  stats::ReplicateImage image;
  uint64_t rounds = 0;
};

/// `samples` of some pixels, the second of two renders.
Sensor sensor_of(const std::string& method, const FlatScene& scene, const PixelRect& rect, uint32_t samples,
                 WavelengthMode mode, const opencl::Options& options) {
  const auto backend = make_zoo_backend(method, scene, {}, {mode, SamplerType::kSobol, 5, 1}, options);
  render_part(*backend, rect, 1, samples);
  const uint64_t before = backend->statistics().device_rounds;
  Sensor sensor{render_part(*backend, rect, 1, samples), 0};
  sensor.rounds = backend->statistics().device_rounds - before;
  return sensor;
}

/// 12 pixels: 63 rounds of 16 samples are one, with the bits that they have one by one (a pool of few paths), and where only
/// some of them fit the memory.
TEST(RoundsOfFewPixels, AreOneWithTheSameBits) {
  const ZooFolder folder;
  const FlatScene scene = folder.flatten(zoo_scene("crop_window"), "450:650:4");
  const PixelRect rect{28, 3, 4, 3};
  for (const std::string method : {"opencl:dpept-batch", "opencl:dpept-path"}) {
    for (const WavelengthMode mode : {WavelengthMode::kShared, WavelengthMode::kPerPath}) {
      const Sensor usual = sensor_of(method, scene, rect, 1000, mode, {});
      const Sensor one_by_one = sensor_of(method, scene, rect, 1000, mode, {.tuning = {.pool_slots = 1}});
      const Sensor narrow =
          sensor_of(method, scene, rect, 1000, mode, {.device_memory = uint64_t{1000} << 10});
      EXPECT_LE(usual.rounds, 4u) << method;
      EXPECT_GE(one_by_one.rounds, 63u) << method;
      EXPECT_EQ(usual.image.means, one_by_one.image.means) << method;
      EXPECT_GT(narrow.rounds, usual.rounds) << method;
      EXPECT_LT(narrow.rounds, 63u) << method;
      EXPECT_EQ(usual.image.means, narrow.image.means) << method;
    }
  }
}

}  // namespace
}  // namespace kiloband::test::waits_test
