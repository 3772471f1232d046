// How often the host waits for the device: at most twice a round, once rounds are known; and the film's pieces.
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

}  // namespace
}  // namespace kiloband::test::waits_test
