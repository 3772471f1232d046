// kiloband tune: what it finds is kept for the device, and changes no image.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "src_gpu/tuning/tuning_store.hpp"
#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test::tune_test {
namespace {

using Names = std::vector<std::string>;

/// A cache of programs and tunings that is the test's own.
class ProgramTune : public testing::Test {
 protected:
  Outcome run(const Names& arguments, Treatment treatment = {}) {
    treatment.environment = {{"XDG_CACHE_HOME", (folder_.path() / "cache").string()}};
    return run_program(folder_, arguments, treatment);
  }
  std::string image() {
    const Outcome outcome = run({"render", cornell_box(), "--size", "40x40", "--bands", "400:700:5", "--spp",
                                 "20", "--backend", "opencl", "-o", "a.hdr", "--stats", "s.json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return folder_.read("a.img");
  }
  opencl::TuningStore store() const {
    return opencl::TuningStore(folder_.path() / "cache" / "kiloband" / "tuning");
  }

  const TemporaryFolder folder_;
};

TEST_F(ProgramTune, KeepsWhatItFindsUntilItIsForgotten) {
  const Outcome outcome = run({"tune", cornell_box(), "--size", "32x32", "--bands", "400:700:5", "--seconds",
                               "0.01", "--max-depth", "2"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("5 channels"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("paths in flight"), std::string::npos) << outcome.err;
  const auto kept = store().load(opencl::select_device(std::nullopt));
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].method, "dpept-batch");
  EXPECT_EQ(kept[0].channels, 5u);
  EXPECT_NE(run({"tune", "--forget"}).out.find("usual sizes again"), std::string::npos);
  EXPECT_NE(run({"tune", "--forget"}).out.find("nothing was kept"), std::string::npos);
}

/// Its speeds are those of the sizes that were kept.
TEST_F(ProgramTune, BenchSaysWhatIsKept) {
  opencl::TunedMethod tuned;
  tuned.method = "pt";
  tuned.channels = 7;
  tuned.tuning.pool_slots = 64;
  EXPECT_EQ(store().save(opencl::select_device(std::nullopt), tuned), "");
  const Outcome outcome = run(
      {"bench", "channels", "--quick", "--backends", "opencl:pt", "--no-report", "-o", "out"},
      {.signal = SIGINT, .after_text = "channels"});  // the facts of the machine are all that it is asked for
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const auto kept = read_json(folder_, "out/bench.json")["machine"]["opencl"]["tuned"];
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0], (nlohmann::json{{"method", "pt"}, {"channels", 7}, {"sizes", "paths in flight 64"}}));
}

TEST_F(ProgramTune, RendersUseItWithTheSameBits) {
  const std::string usual = image();
  const auto slots = [&] { return read_json(folder_, "s.json")["pool_slots"].get<uint32_t>(); };
  const uint32_t usual_slots = slots();
  opencl::TunedMethod tuned;
  tuned.method = "dpept-batch";
  tuned.channels = 7;
  tuned.tuning.pool_slots = 64;
  tuned.tuning.round_paths = 1024;
  EXPECT_EQ(store().save(opencl::select_device(std::nullopt), tuned), "");
  EXPECT_TRUE(image() == usual);
  EXPECT_EQ(slots(), 64u);
  EXPECT_GT(usual_slots, 64u);
}

TEST_F(ProgramTune, SaysBeforeItMeasuresThatNothingCanBeKept) {
  std::ofstream(folder_.path() / "cache") << "no folder";
  const Outcome outcome = run({"tune", "--quiet"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("sizes cannot be kept: cannot write '"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out, "");
}

TEST_F(ProgramTune, RefusesWhatItCannotTime) {
  EXPECT_EQ(run({"tune", "--device", "no such device"}).code, 2);
  for (const char* seconds : {"0", "nan", "-1", "61", "inf"})
    EXPECT_EQ(run({"tune", "--seconds", seconds}).code, 2) << seconds;
  EXPECT_EQ(run({"tune", "--forget", "--seconds", "0"}).code, 2);
  EXPECT_EQ(run({"tune", "missing.xml"}).code, 2);
}

}  // namespace
}  // namespace kiloband::test::tune_test
