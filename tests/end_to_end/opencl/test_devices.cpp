// Renders on several OpenCL devices, the halves of one: the files of a render on one, whatever fails on the way.
#include <gtest/gtest.h>
#include <signal.h>

#include "src_gpu/device/device.hpp"
#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;
using Environment = std::vector<std::pair<std::string, std::string>>;

/// 75 x 50 pixels are six blocks.
Names box_render(const Names& more, const std::string& backend = "opencl") {
  Names arguments{"render",      cornell_box(), "--size",    "75x50", "--bands", "400:700:5",
                  "--max-depth", "4",           "--backend", backend, "-o",      "a.hdr"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class ProgramDevices : public testing::Test {
 protected:
  void SetUp() override {
    if (opencl::select_device("0").compute_units < 2) GTEST_SKIP() << "a device of one compute unit";
  }

  Outcome run(const Names& more, const Treatment& treatment = {}) {
    return run_program(folder_, box_render(more), treatment);
  }
  /// The image on the whole device.
  std::string expected(const Names& more) {
    const Outcome outcome = run(more);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return folder_.read("a.img");
  }

  const TemporaryFolder folder_;
};

TEST_F(ProgramDevices, GiveTheBytesOfOne) {
  for (const Names& options : {Names{"--spp", "4"}, Names{"--spp", "40", "--method", "dpept-path"},
                               Names{"--spp", "6", "--replicates", "2", "--variance", "--method", "pt",
                                     "--sampler", "independent"}}) {
    const std::string image = expected(options);
    Names halves = options;
    halves.insert(halves.end(), {"--device", "0/2", "--stats", "s.json"});
    const Outcome outcome = run(halves);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(folder_.read("a.img") == image) << options.back();
    const nlohmann::json stats = read_json(folder_, "s.json");
    ASSERT_EQ(stats["devices"].size(), 2u);
    EXPECT_EQ(stats["backend"], "opencl");
    EXPECT_EQ(stats["device"], stats["devices"][0]["device"]);
    uint64_t paths = 0;
    for (const auto& device : stats["devices"]) {
      EXPECT_EQ(device["failure"], nullptr);
      paths += device["paths"].get<uint64_t>();
    }
    EXPECT_EQ(paths, stats["paths"]);
  }
}

TEST_F(ProgramDevices, GoOnInACheckpointOfOneAndTheOtherWayRound) {
  const std::string image = expected({"--spp", "24"});
  for (const bool halves_first : {true, false}) {
    const TemporaryFolder folder;
    const auto render = [&](const std::string& spp, bool halves) {
      return run_program(folder, box_render({"--spp", spp, "--checkpoint", "c", "--resume", "--device",
                                             halves ? "0/2" : "0"}));
    };
    EXPECT_EQ(render("7", halves_first).code, 0);
    const Outcome second = render("24", !halves_first);
    EXPECT_EQ(second.code, 0) << second.err;
    EXPECT_TRUE(folder.read("a.img") == image) << halves_first;
  }
}

/// A call of one of the devices from which on all fail.
struct DeviceFault {
  std::string function, call;
  bool
      surely;  // among those of the first work that a device is given; it may be given no more on a busy machine
};

/// One of the devices is lost for good, at its first launch or a later one: the other renders what it had.
TEST_F(ProgramDevices, OneMayFail) {
  const std::string image = expected({"--spp", "40"});  // in parts
  for (const std::string device : {"1", "2"}) {
    for (const auto& [function, call, surely] :
         {DeviceFault{"clEnqueueNDRangeKernel", "1", true}, DeviceFault{"clEnqueueNDRangeKernel", "4", true},
          DeviceFault{"clEnqueueNDRangeKernel", "40", false}, DeviceFault{"clEnqueueReadBuffer", "2", true},
          DeviceFault{"clEnqueueReadBuffer", "10", false}}) {
      SCOPED_TRACE(device + ", " + function + " " + call);
      const Outcome outcome = run({"--spp", "40", "--device", "0/2", "--stats", "s.json"},
                                  {.environment = {{"LD_PRELOAD", SHIM_LIBRARY},
                                                   {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                                   {"KILOBAND_SHIM_DEVICE", device},
                                                   {"KILOBAND_SHIM_FUNCTION", function},
                                                   {"KILOBAND_SHIM_NTH", call},
                                                   {"KILOBAND_SHIM_CODE", "-36"},
                                                   {"KILOBAND_SHIM_REPEAT", "1"}}});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_TRUE(folder_.read("a.img") == image);
      const nlohmann::json stats = read_json(folder_, "s.json")["devices"][std::stoul(device) - 1];
      if (!surely && stats["failure"].is_null()) continue;
      expect_text(outcome.err, ": device " + device + " of 2 is left out, its work goes to the others\n");
      ASSERT_TRUE(stats["failure"].is_string());
      EXPECT_NE(stats["failure"].get<std::string>().find(function), std::string::npos);
    }
  }
}

/// A device that has not even a context is left out from the start.
TEST_F(ProgramDevices, OneMayFailAtTheStart) {
  const std::string image = expected({"--spp", "4"});
  const auto without = [&](const std::string& repeat) {
    return run({"--spp", "4", "--device", "0/2"},
               {.environment = {{"LD_PRELOAD", SHIM_LIBRARY},
                                {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                {"KILOBAND_SHIM_FUNCTION", "clCreateContext"},
                                {"KILOBAND_SHIM_REPEAT", repeat}}});
  };
  const Outcome first = without("0");
  EXPECT_EQ(first.code, 0) << first.err;
  expect_text(first.err, ": the render goes without it (device 1 of 2)\n");
  EXPECT_TRUE(folder_.read("a.img") == image);
  EXPECT_EQ(without("1").code, 3);
}

/// Where no OpenCL device has a context the processor renders alone.
TEST_F(ProgramDevices, AllButTheProcessorMayFailAtTheStart) {
  ASSERT_EQ(run_program(folder_, box_render({"--spp", "4"}, "cpu")).code, 0);
  const std::string image = folder_.read("a.img");
  const Outcome outcome = run_program(folder_, box_render({"--spp", "4"}, "cpu+opencl"),
                                      {.environment = {{"LD_PRELOAD", SHIM_LIBRARY},
                                                       {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                                       {"KILOBAND_SHIM_FUNCTION", "clCreateContext"},
                                                       {"KILOBAND_SHIM_REPEAT", "1"}}});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  expect_text(outcome.err, ": the render goes without it\n");
  EXPECT_TRUE(folder_.read("a.img") == image);
}

TEST_F(ProgramDevices, WhereAllFailTheRenderFails) {
  const Outcome outcome = run({"--spp", "40", "--device", "0/2"},
                              {.environment = {{"LD_PRELOAD", SHIM_LIBRARY},
                                               {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                               {"KILOBAND_SHIM_FUNCTION", "clEnqueueReadBuffer"},
                                               {"KILOBAND_SHIM_NTH", "20"},
                                               {"KILOBAND_SHIM_CODE", "-36"},
                                               {"KILOBAND_SHIM_REPEAT", "1"}}});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  expect_text(outcome.err, "kiloband: device '");
  EXPECT_EQ(folder_.list(), Names{});
}

TEST_F(ProgramDevices, AreInterruptedTogether) {
  ASSERT_EQ(run({"--spp", "2"}).code, 0);  // kernels are compiled
  const Names endless{"--spp", "100000000", "--device", "0/2", "--stats", "s.json"};
  const Outcome outcome =
      run_program(folder_, box_render(endless, "cpu+opencl"),
                  {.signal = SIGINT, .after_text = "devices of several kinds", .after_seconds = 1.5});
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const nlohmann::json stats = read_json(folder_, "s.json");
  EXPECT_EQ(stats["interrupted"], true);
  EXPECT_EQ(stats["backend"], "cpu+opencl");
  ASSERT_EQ(stats["devices"].size(), 3u);
  for (const auto& device : stats["devices"]) EXPECT_GT(device["paths"].get<uint64_t>(), 0u);
  EXPECT_GT(stats["spp"].get<uint64_t>(), 0u);
}

TEST_F(ProgramDevices, StopAtATimeAndAtAnError) {
  Outcome outcome = run({"--time", "1s", "--device", "0/2", "--stats", "s.json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_json(folder_, "s.json")["ended_by"], "time");
  const std::string image = expected({"--target-error", "40%", "--replicates", "4"});
  outcome = run({"--target-error", "40%", "--replicates", "4", "--device", "0/2"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(folder_.read("a.img") == image);
}

TEST_F(ProgramDevices, TraceIsThatOfOne) {
  const Names trace{"trace", cornell_box(), "--size", "75x50", "--pixel", "40,40", "--device"};
  const auto text = [&](const std::string& device) {
    Names arguments = trace;
    arguments.push_back(device);
    const Outcome outcome = run_program(folder_, arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out;
  };
  EXPECT_EQ(text("0/2"), text("0"));
}

TEST_F(ProgramDevices, WrongChoices) {
  const auto refusal = [&](const std::string& device) {
    const Outcome outcome = run({"--device", device});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    return outcome.err;
  };
  expect_text(refusal("0,0"), "kiloband: --device 0,0: device 0 '");
  expect_text(refusal("0,99"), "kiloband: no OpenCL device 99: there is 0 '");
  expect_text(refusal("0/0"), "kiloband: --device 0/0: must be at least 1 part\n");
  expect_text(refusal("0/4096"), "in 4096 parts: it has ");
}

}  // namespace
}  // namespace kiloband::test
