// Kills on an OpenCL device.
#include <gtest/gtest.h>

#include "tests/end_to_end/support/kills.hpp"

namespace kiloband::test {
namespace {

TEST(OpenclCheckpoint, KilledRendersEndWithTheBitsOfUninterruptedOnes) {
  const std::vector<std::string> opencl{"--backend", "opencl", "--spp", "80", "--replicates", "2"};
  std::vector<std::string> sobol = opencl, independent = opencl;
  sobol.push_back("--variance");
  independent.insert(independent.end(), {"--sampler", "independent"});
  expect_same_files_after_kills(sobol, 1, 3);
  expect_same_files_after_kills(independent, 1, 4);
}

}  // namespace
}  // namespace kiloband::test
