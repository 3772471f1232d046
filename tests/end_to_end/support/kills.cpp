#include "tests/end_to_end/support/kills.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <random>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

constexpr int kMostKills = 3;  // then the render may end
/// Times as many renders as were asked for: on a busy machine one may be over before the moment that the length of another suggests.
constexpr int kPatience = 10;

std::vector<std::string> box(const std::vector<std::string>& options) {
  std::vector<std::string> all{"--size", "40x33", "--bands", "400:700:3", "-o", "a.hdr"};
  all.insert(all.end(), options.begin(), options.end());
  return quiet_render(cornell_box(), all);
}

/// Returns how often the render was killed.
int render_with_kills(const TemporaryFolder& folder, std::vector<std::string> options, double seconds,
                      std::mt19937_64& random) {
  options.insert(options.end(), {"--checkpoint", "c", "--checkpoint-interval", "0.004s", "--resume"});
  std::uniform_real_distribution<double> moment(0, seconds);
  for (int kills = 0; kills < kMostKills; ++kills) {
    const Outcome outcome = run_program(
        folder, box(options), {.signal = SIGKILL, .after_text = "", .after_seconds = moment(random)});
    if (outcome.signal == SIGKILL) continue;
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return kills;
  }
  const Outcome outcome = run_program(folder, box(options));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return kMostKills;
}

}  // namespace

void expect_same_files_after_kills(const std::vector<std::string>& options, int renders, uint64_t seed) {
  const TemporaryFolder first, whole;
  ASSERT_EQ(run_program(first, box(options)).code,
            0);  // a device may compile its kernels now, which takes longer
  const Outcome once = run_program(whole, box(options));
  ASSERT_EQ(once.code, 0) << once.err;
  std::mt19937_64 random(seed);
  int kills = 0;
  for (int i = 0; i < renders || (kills < renders && i < kPatience * renders); ++i) {
    const TemporaryFolder folder;
    kills += render_with_kills(folder, options, once.seconds, random);
    for (const std::string& file : whole.list())
      EXPECT_TRUE(whole.read(file) == folder.read(file)) << file << ", render " << i;
  }
  EXPECT_GE(kills, renders);  // else the moments are not spread over the render
}

}  // namespace kiloband::test
