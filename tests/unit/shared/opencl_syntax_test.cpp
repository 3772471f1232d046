// Every header of src/shared compiles as OpenCL C 1.2, without a warning.
// Checked with clang, which needs no device.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "base/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

class OpenClSyntax : public ::testing::Test {
 protected:
  void SetUp() override { folder_ = kiloband::make_temporary_folder("kiloband_opencl_syntax"); }
  void TearDown() override { fs::remove_all(folder_); }

  // Compiles a file that holds `text`; returns the compiler's status and its messages.
  std::pair<int, std::string> compile(const std::string& text) {
    std::ofstream(folder_ / "unit.cl") << text;
    const std::string command =
        std::string(KILOBAND_CLANG) +
        " -x cl -cl-std=CL1.2 -target spir64 -Xclang -finclude-default-header -Wall -Wextra"
        " -Werror -fsyntax-only '-I" KILOBAND_SOURCE_DIR "/src' '" +
        (folder_ / "unit.cl").string() + "' 2> '" + (folder_ / "log").string() + "'";
    const int status = std::system(command.c_str());
    std::ostringstream log;
    log << std::ifstream(folder_ / "log").rdbuf();
    return {status, log.str()};
  }

  fs::path folder_;
};

TEST_F(OpenClSyntax, SharedHeadersCompile) {
  int headers = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(KILOBAND_SOURCE_DIR "/src/shared")) {
    if (entry.path().extension() != ".h") continue;
    ++headers;
    const auto [status, log] = compile("#include \"shared/" + entry.path().filename().string() + "\"\n");
    EXPECT_EQ(status, 0) << entry.path().filename() << ":\n" << log;
  }
  EXPECT_GE(headers, 10);
}

// The check itself can fail.
TEST_F(OpenClSyntax, CxxIsRefused) {
  const auto [status, log] =
      compile("#include \"shared/lang.h\"\nstatic inline float f(float& x) { return x; }\n");
  EXPECT_NE(status, 0);
  EXPECT_NE(log.find("error"), std::string::npos);
}

}  // namespace
