// kiloband devices: a table, or the plain answer that there is none.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/end_to_end/support/program.hpp"

namespace kiloband::test {
namespace {

TEST(Devices, ListsThem) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(folder, {"devices"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.rfind("index  name", 0), 0u) << outcome.out;
  EXPECT_NE(outcome.out.find("\n    0  "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(" GiB\n"), std::string::npos) << outcome.out;
}

TEST(Devices, NoneIsAnAnswer) {
  const TemporaryFolder folder;
  setenv("OCL_ICD_VENDORS", (folder / "nothing").c_str(), 1);
  const Outcome outcome = run_program(folder, {"devices"});
  unsetenv("OCL_ICD_VENDORS");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.rfind("no OpenCL device\n", 0), 0u) << outcome.out;
  EXPECT_EQ(outcome.err, "");
}

TEST(Devices, TakesNoArguments) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_program(folder, {"devices", "0"}).code, 2);
}

}  // namespace
}  // namespace kiloband::test
