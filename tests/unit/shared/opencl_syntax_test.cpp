// Every header of src/shared compiles as OpenCL C 1.2, without a warning.
#include "tests/support/opencl_syntax.hpp"

#include <gtest/gtest.h>

namespace kiloband::test {
namespace {

std::string compile(const std::string& text) {
  const TemporaryFolder folder;
  return opencl_syntax(folder.write("unit.cl", text));
}

TEST(OpenClSyntax, SharedHeadersCompile) {
  int headers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(KILOBAND_SOURCE_DIR "/src/shared")) {
    if (entry.path().extension() != ".h") continue;
    ++headers;
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(compile("#include \"shared/" + name + "\"\n"), "") << name;
  }
  EXPECT_GE(headers, 10);
}

// The check itself can fail.
TEST(OpenClSyntax, CxxIsRefused) {
  EXPECT_NE(
      compile("#include \"shared/lang.h\"\nstatic inline float f(float& x) { return x; }\n").find("error"),
      std::string::npos);
}

}  // namespace
}  // namespace kiloband::test
