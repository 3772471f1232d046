// The sources have no planted fault, nor has what is built of them.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "tests/unit/structure/source_tree.hpp"
#include "tests/unit/validation/faults/shell.hpp"

namespace kiloband::test {
namespace {

TEST(NoFaults, SourcesHaveNone) {
  std::size_t files = 0;
  for (const SourceFile& file : read_files({"src", "src_cpu", "src_gpu", "kernels", "app"})) {
    ++files;
    for (const char* word : {"KB_PLANTED", "planted_", "KILOBAND_FAULT", "validation/faults"})
      EXPECT_EQ(file.text.find(word), std::string::npos) << file.path << " has " << word;
  }
  EXPECT_GT(files, 400u) << "the scan of the sources has lost its way";
}

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
  EXPECT_EQ(run_shell("'" KILOBAND_PROGRAM "' render scene.xml --fault cpu:missing-cosine").code, 2);
}

}  // namespace
}  // namespace kiloband::test
