// OpenCL calls that fail, one after the other: the program ends with the image that it would have made, or
// with exit code 3, one message and no file. Every call of a small render is made to fail in turn; of the many allocations and the waits
// that they have in common every third one, of writes every second, of reads with codes after the first every third: all with
// KILOBAND_THOROUGH.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;
using Environment = std::vector<std::pair<std::string, std::string>>;

struct Finished {
  Outcome outcome;
  std::map<std::string, long>
      report;         // of the shim: calls by name, "live_buffers", "failed", "clFinish_1", ...
  std::string image;  // bytes, empty if there is none
  Names files;

  bool says(const std::string& text) const { return outcome.err.find(text) != std::string::npos; }
};

/// 8 x 8 pixels in 8 channels, 2 samples, paths of three vertices: few calls (8 launches), which fail one after the other.
Names small_render(const Names& more = {}) {
  Names arguments{"render", cornell_box(), "--size", "8x8",       "--bands", "400:700:8", "--spp",
                  "2",      "--max-depth", "3",      "--backend", "opencl",  "-o",        "a.hdr"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

Finished run(Environment environment, const Names& arguments) {
  const TemporaryFolder folder;
  environment.emplace_back("LD_PRELOAD", SHIM_LIBRARY);
  environment.emplace_back("ASAN_OPTIONS", "verify_asan_link_order=0");
  environment.emplace_back("KILOBAND_SHIM_REPORT", (folder / "report").string());
  Finished result;
  result.outcome = run_program(folder, arguments, {.environment = environment});
  std::ifstream stream(folder / "report");
  std::string name;
  for (long value = 0; stream >> name >> value;) result.report[name] = value;
  std::filesystem::remove(folder / "report");
  result.files = folder.list();
  if (std::filesystem::exists(folder / "a.img")) result.image = folder.read("a.img");
  return result;
}

struct Fault {
  std::string function;
  int code = 0;
  long nth = 1;
  bool repeat = false;
};

Finished run_with(const Fault& fault, const Names& arguments = small_render()) {
  return run({{"KILOBAND_SHIM_FUNCTION", fault.function},
              {"KILOBAND_SHIM_CODE", std::to_string(fault.code)},
              {"KILOBAND_SHIM_NTH", std::to_string(fault.nth)},
              {"KILOBAND_SHIM_REPEAT", fault.repeat ? "1" : "0"}},
             arguments);
}

/// Exit code 0 and the image, or 3, one message that names the call, and no file. Nothing leaks either way.
void expect_clean_end(const Finished& result, const Finished& good, const Fault& fault) {
  const std::string where = fault.function + " " + std::to_string(fault.nth) + ": " +
                            std::to_string(fault.code) + "\n" + result.outcome.err;
  EXPECT_EQ(result.outcome.signal, 0) << where;
  EXPECT_EQ(result.report.at("live_buffers"), 0) << where;
  EXPECT_GE(result.report.at("failed"), 1) << where;
  if (result.outcome.code == 0) {
    EXPECT_TRUE(result.image == good.image) << where;
    EXPECT_EQ(result.files, good.files) << where;
    return;
  }
  EXPECT_EQ(result.outcome.code, 3) << where;
  EXPECT_TRUE(result.says("kiloband: device '")) << where;
  EXPECT_TRUE(result.says(fault.function)) << where;
  EXPECT_TRUE(result.says("(" + std::to_string(fault.code) + ")")) << where;
  EXPECT_EQ(result.files, Names{}) << where;
}

constexpr const char* kRebuilt = "device lost, context rebuilt, work repeated\n";

class OpenclFault : public ::testing::Test {
 protected:
  /// Also fills the cache of programs: every test is a process of its own.
  void SetUp() override {
    ASSERT_EQ(run({}, small_render()).outcome.code, 0);
    good_ = run({}, small_render());
    ASSERT_EQ(good_.outcome.code, 0) << good_.outcome.err;
    ASSERT_EQ(good_.report.at("live_buffers"), 0);
    ASSERT_FALSE(good_.image.empty());
  }

  long calls(const std::string& function) const { return good_.report.at(function); }

  /// Fails call 1, 2, 3 ... of the good run in turn, each once, or those of them that are wanted. Returns how many runs recovered.
  long fail_each(
      const std::string& function, int code, const std::string& note,
      const std::function<bool(long)>& wanted = [](long) { return true; }) const {
    long recovered = 0;
    for (long nth = 1; nth <= calls(function); ++nth) {
      if (!wanted(nth)) continue;
      const Fault fault{function, code, nth};
      const Finished result = run_with(fault);
      expect_clean_end(result, good_, fault);
      if (result.outcome.code != 0 || !result.says(note)) continue;
      ++recovered;
    }
    return recovered;
  }

  /// Buffers of device memory that the good run had asked for before a wait; the last one has waits of its own.
  long buffers_before(long wait) const {
    return wait < 1 ? 0 : calls("clFinish_" + std::to_string(std::min(wait, calls("clFinish"))));
  }

  Finished good_;
};

/// A lost device at any launch, transfer: set up again, the same image, one line.
TEST_F(OpenclFault, EveryLaunch) {
  ASSERT_GT(calls("clEnqueueNDRangeKernel"), 0);
  EXPECT_EQ(fail_each("clEnqueueNDRangeKernel", -5, kRebuilt), calls("clEnqueueNDRangeKernel"));
}
TEST_F(OpenclFault, EveryRead) {
  ASSERT_GT(calls("clEnqueueReadBuffer"), 0);
  for (const int code : {-5, -36, -9999}) {
    long tried = 0;
    const bool all = code == -5 || thorough();
    EXPECT_EQ(fail_each("clEnqueueReadBuffer", code, kRebuilt,
                        [&](long nth) { return (all || nth % 3 == 1) && ++tried > 0; }),
              tried);
    EXPECT_GE(tried, calls("clEnqueueReadBuffer") / (all ? 1 : 3));
  }
}
TEST_F(OpenclFault, EveryWrite) {
  ASSERT_GT(calls("clEnqueueWriteBuffer"), 0);
  long tried = 0;
  EXPECT_EQ(fail_each("clEnqueueWriteBuffer", -36, kRebuilt,
                      [&](long nth) { return (thorough() || nth % 2 == 1) && ++tried > 0; }),
            tried);
  EXPECT_GE(tried, calls("clEnqueueWriteBuffer") / 2);
}

/// Refused memory: the scene's own buffers are needed, the pool can be smaller.
TEST_F(OpenclFault, EveryAllocation) {
  long tried = 0;
  const long smaller = fail_each("clCreateBuffer", -4, "device memory: 64 of 64 pixels at a time",
                                 [&](long nth) { return (thorough() || nth % 3 == 1) && ++tried > 0; });
  EXPECT_GT(smaller, tried / 5);
  EXPECT_LT(smaller, tried);
  EXPECT_GT(tried, 20);
}

/// Waits stand before and after allocations, after evaluation, and at the end of the queue. An allocation's two, which the same lines
/// call for every buffer, with a handler each, fail in turn: that before the first buffer, that after the second (the third of what
/// follows, where not all are tried), and so on. So a device is lost at buffers everywhere, by both handlers, in half the time of failing
/// both at each. All other waits fail.
TEST_F(OpenclFault, EveryWait) {
  const long step = thorough() ? 2 : 6;
  long before = 0, after = 0, others = 0;
  fail_each("clFinish", -36, kRebuilt, [&](long wait) {
    const long buffers = buffers_before(wait);
    if (buffers_before(wait + 1) > buffers && buffers % step == 0) return ++before > 0;
    if (buffers > buffers_before(wait - 1) && buffers % step == step - 2) return ++after > 0;
    return buffers_before(wait + 1) == buffers && buffers == buffers_before(wait - 1) && ++others > 0;
  });
  ASSERT_GT(others, 0);
  EXPECT_NEAR(before + after,
              2.0 * static_cast<double>(buffers_before(calls("clFinish"))) / static_cast<double>(step), 1);
  EXPECT_GT(before, 60 / step);
  EXPECT_NEAR(before, after, 1);
}

TEST_F(OpenclFault, SetUp) {
  for (const char* function : {"clCreateContext", "clCreateCommandQueue", "clCreateKernel"})
    EXPECT_EQ(fail_each(function, -6, ""), 0) << function;
}

TEST_F(OpenclFault, LostForEver) {
  for (const char* function : {"clEnqueueNDRangeKernel", "clEnqueueReadBuffer", "clEnqueueWriteBuffer"}) {
    const Fault fault{function, -36, 2, true};
    const Finished result = run_with(fault);
    expect_clean_end(result, good_, fault);
    EXPECT_EQ(result.outcome.code, 3);
  }
}

TEST_F(OpenclFault, MemoryRefusedForEver) {
  for (const long nth : {1L, good_.report.at("clCreateBuffer")}) {
    const Fault fault{"clCreateBuffer", -4, nth, true};
    const Finished result = run_with(fault);
    expect_clean_end(result, good_, fault);
    EXPECT_EQ(result.outcome.code, 3);
  }
}

/// Drivers that allocate lazily refuse memory at a launch: the rest is done with half of it.
TEST_F(OpenclFault, MemoryRefusedAtALaunch) {
  const Fault fault{"clEnqueueNDRangeKernel", -4, 6};
  const Finished result = run_with(fault);
  expect_clean_end(result, good_, fault);
  EXPECT_EQ(result.outcome.code, 0);
  EXPECT_TRUE(result.says("MiB of device memory from now on\n")) << result.outcome.err;
}

/// The scene is most of what is in use: half of the rest is given up, not half of all.
TEST_F(OpenclFault, MemoryRefusedAtALaunchBesideALargeScene) {
  const TemporaryFolder folder;
  constexpr std::size_t kEdge = 1024;
  std::string picture = "PF\n1024 1024\n-1.0\n";
  const float grey = 0.5f;
  for (std::size_t i = 0; i < 3 * kEdge * kEdge; ++i)
    picture.append(reinterpret_cast<const char*>(&grey), sizeof grey);
  folder.write("grey.pfm", picture);
  const auto scene = folder.write("scene.xml", R"(<scene version="3.0.0">
<sensor type="perspective"/><emitter type="constant"/>
<shape type="sphere"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="grey.pfm"/>
</texture></bsdf><transform name="to_world"><translate z="4"/></transform></shape></scene>)");
  Names arguments = small_render();
  arguments[1] = scene.string();
  const Finished good = run({}, arguments);
  ASSERT_EQ(good.outcome.code, 0) << good.outcome.err;
  const Fault fault{"clEnqueueNDRangeKernel", -4, good.report.at("clEnqueueNDRangeKernel") - 2};
  const Finished result = run_with(fault, arguments);
  expect_clean_end(result, good, fault);
  EXPECT_EQ(result.outcome.code, 0) << result.outcome.err;
  EXPECT_TRUE(result.says("MiB of device memory from now on\n")) << result.outcome.err;
}

/// While a lost device is set up again there is no memory, not even for the scene.
TEST_F(OpenclFault, LostAndThenNoMemory) {
  const Finished result = run({{"KILOBAND_SHIM_FUNCTION", "clEnqueueNDRangeKernel"},
                               {"KILOBAND_SHIM_CODE", "-5"},
                               {"KILOBAND_SHIM_NTH", "4"},
                               {"KILOBAND_SHIM_THEN", "clCreateBuffer"}},
                              small_render());
  expect_clean_end(result, good_, {"clCreateBuffer", -4});
  EXPECT_EQ(result.outcome.code, 3);
  EXPECT_TRUE(result.says(kRebuilt)) << result.outcome.err;
}

/// --quiet keeps warnings and errors only; statistics tell of the loss.
TEST_F(OpenclFault, LossIsInTheStatistics) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(folder, small_render({"--quiet", "--stats", "s.json"}),
                                      {.environment = {{"LD_PRELOAD", SHIM_LIBRARY},
                                                       {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                                       {"KILOBAND_SHIM_FUNCTION", "clEnqueueReadBuffer"},
                                                       {"KILOBAND_SHIM_CODE", "-36"}}});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json stats = read_json(folder, "s.json");
  EXPECT_EQ(stats["device_losses"], 1);
  EXPECT_GT(stats["longest_launch_seconds"], 0.0);
}

}  // namespace
}  // namespace kiloband::test
