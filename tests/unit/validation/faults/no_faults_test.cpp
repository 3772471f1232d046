// A build without KILOBAND_FAULTS has no planted fault.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "shared/planted_faults.h"

namespace {

// Constants: the compiler drops what stands behind them.
static_assert(KB_PLANTED(COSINE) == 0 && KB_PLANTED_OPENCL(COSINE) == 0 && KB_PLANTED_SHARED(COSINE) == 0);
static_assert(KB_PLANTED_NUMBER == 0 && KB_PLANTED_OPENCL_NUMBER == 0 && KB_PLANTED_SHARED_NUMBER == 0);

TEST(NoFaults, ProgramHasNeitherOptionNorVariable) {
  std::ostringstream bytes;
  bytes << std::ifstream(KILOBAND_PROGRAM, std::ios::binary).rdbuf();
  const std::string program = bytes.str();
  ASSERT_NE(program.find("--replicates"), std::string::npos) << "the scan of the program has lost its way";
  EXPECT_EQ(program.find("--fault"), std::string::npos);
  EXPECT_EQ(program.find(std::string("KILOBAND_FAULT") + '\0'),
            std::string::npos);  // with its end: not ...FAULTS
}

TEST(NoFaults, OptionIsUnknown) {
  const int status =
      std::system("'" KILOBAND_PROGRAM "' render scene.xml --fault cpu:missing-cosine > /dev/null 2>&1");
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 2);
}

}  // namespace
