// Devices that fail: every call of every function in turn ends in one clear exception,
// without a leaked buffer.
#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <set>

#include "tests/unit/src_gpu/device/gpu_fixture.hpp"

namespace kiloband::opencl::test {
namespace {

struct Finished {
  int code = -1;    // exit code; 128 + signal where the program crashed
  std::string out;  // standard output
  std::map<std::string, long> report;
};

class Shim : public ::testing::Test {
 protected:
  CacheFolder cache_;

  /// Runs shim_program with these environment variables.
  Finished run(const std::string& environment, const std::string& argument = "") const {
    const std::string report = (cache_.path() / "report").string();
    std::filesystem::remove(report);
    const std::string command = "env KILOBAND_SHIM_REPORT=" + report +
                                " ASAN_OPTIONS=verify_asan_link_order=0 " + environment +
                                " LD_PRELOAD=" SHIM_LIBRARY " " SHIM_PROGRAM " " + argument;
    Finished result;
    std::FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) throw std::runtime_error("popen");
    char buffer[4096];
    while (std::fgets(buffer, sizeof buffer, pipe)) result.out += buffer;
    const int status = pclose(pipe);
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    std::ifstream stream(report);
    std::string name;
    for (long value = 0; stream >> name >> value;) result.report[name] = value;
    return result;
  }
  Finished fail(const std::string& function, long nth, int code, const std::string& more = "",
                const std::string& argument = "") const {
    return run("KILOBAND_SHIM_FUNCTION=" + function + " KILOBAND_SHIM_NTH=" + std::to_string(nth) +
                   " KILOBAND_SHIM_CODE=" + std::to_string(code) + " " + more,
               argument);
  }
};

constexpr const char* kDone = "done 384\n";  // 64 items, 3 added twice

TEST_F(Shim, CountsAndLetsThrough) {
  const Finished result = run("");
  EXPECT_EQ(result.code, 0) << result.out;
  EXPECT_EQ(result.out, kDone);
  EXPECT_EQ(result.report.at("clCreateBuffer"), 2);
  EXPECT_EQ(result.report.at("clEnqueueNDRangeKernel"), 2);
  EXPECT_EQ(result.report.at("clEnqueueReadBuffer"), 1);
  EXPECT_EQ(result.report.at("live_buffers"), 0);
  EXPECT_EQ(result.report.at("failed"), 0);
}

/// Codes by what they may become. The binary of a program may fail as it likes: it is built from source.
TEST_F(Shim, EveryCallInTurn) {
  const Finished good = run("");
  ASSERT_EQ(good.code, 0) << good.out;
  const std::map<std::string, std::pair<int, std::set<int>>> expected{
      {"clCreateContext", {-6, {3}}},
      {"clCreateCommandQueue", {-6, {3}}},
      {"clCreateBuffer", {-4, {4}}},
      {"clCreateKernel", {-6, {3}}},
      {"clCreateProgramWithBinary", {-42, {0}}},
      {"clBuildProgram", {-11, {0}}},
      {"clEnqueueNDRangeKernel", {-5, {5}}},
      {"clEnqueueReadBuffer", {-36, {5}}},
      {"clEnqueueWriteBuffer", {-5, {5}}},
      {"clEnqueueFillBuffer", {-5, {4, 5}}},  // first touch of a buffer, or clear()
      {"clFinish", {-5, {4, 5}}},             // after the first touch, or any other
  };
  for (const auto& [function, outcome] : expected) {
    const long calls = std::max(good.report.at(function), 1L);
    for (long nth = 1; nth <= calls; ++nth) {
      const Finished result = fail(function, nth, outcome.first);
      const std::string where = function + " " + std::to_string(nth) + ": " + result.out;
      // The last wait is the one that closes the queue: the work is done, its failure is no news.
      const bool closing = function == "clFinish" && nth == calls;
      EXPECT_TRUE(closing ? result.code == 0 : outcome.second.contains(result.code))
          << where << " code " << result.code;
      EXPECT_EQ(result.report.at("failed"), 1) << where;
      EXPECT_EQ(result.report.at("live_buffers"), 0) << where;
      if (result.code == 0) {
        EXPECT_EQ(result.out, kDone);
      } else {
        EXPECT_NE(result.out.find(function), std::string::npos) << where;
        EXPECT_NE(result.out.find("(" + std::to_string(outcome.first) + ")"), std::string::npos) << where;
      }
    }
  }
}

TEST_F(Shim, LaunchErrorNamesTheKernel) {
  const Finished result = fail("clEnqueueNDRangeKernel", 2, -5);
  EXPECT_EQ(result.code, 5);
  EXPECT_NE(result.out.find("clEnqueueNDRangeKernel of kernel 'add': CL_OUT_OF_RESOURCES (-5)"),
            std::string::npos)
      << result.out;
}

TEST_F(Shim, LostDeviceIsRebuilt) {
  for (const int code : {-5, -36}) {
    const Finished result = fail("clEnqueueReadBuffer", 1, code, "", "retry");
    EXPECT_EQ(result.code, 0) << result.out;
    EXPECT_EQ(result.out, kDone);
    EXPECT_EQ(result.report.at("live_buffers"), 0);
    EXPECT_EQ(result.report.at("clCreateContext"), 2);
  }
  const Finished forever = fail("clEnqueueReadBuffer", 1, -36, "KILOBAND_SHIM_REPEAT=1", "retry");
  EXPECT_EQ(forever.code, 5) << forever.out;
  EXPECT_EQ(forever.report.at("failed"), 2);
  EXPECT_EQ(forever.report.at("live_buffers"), 0);
}

TEST_F(Shim, BuildThatNeverWorks) {
  const Finished result = fail("clBuildProgram", 1, -11, "KILOBAND_SHIM_REPEAT=1");
  EXPECT_EQ(result.code, 6) << result.out;
}

TEST_F(Shim, NoPlatform) {
  const std::string message =
      "no OpenCL platform: no OpenCL driver is installed (for processors: pocl-opencl-icd)\n";
  const Finished none = fail("clGetPlatformIDs", 1, -1001, "KILOBAND_SHIM_REPEAT=1");
  EXPECT_EQ(none.code, 3);
  EXPECT_EQ(none.out, message);
  const Finished no_vendor = run("OCL_ICD_VENDORS=" + (cache_.path() / "nothing").string());
  EXPECT_EQ(no_vendor.code, 3);
  EXPECT_EQ(no_vendor.out, message);
  const Finished broken = fail("clGetPlatformIDs", 1, -6, "KILOBAND_SHIM_REPEAT=1");
  EXPECT_EQ(broken.code, 3);
  EXPECT_EQ(broken.out, "OpenCL: clGetPlatformIDs: CL_OUT_OF_HOST_MEMORY (-6)\n");
}

}  // namespace
}  // namespace kiloband::opencl::test
