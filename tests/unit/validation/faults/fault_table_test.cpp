// The table of planted faults and their selection (a build with KILOBAND_FAULTS).
#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>

#include "shared/planted_faults.h"
#include "tests/support/messages.hpp"
#include "tests/support/opencl_syntax.hpp"
#include "tests/support/zoo/scene_zoo.hpp"
#include "validation/faults/selection.hpp"
#include "validation/faults/table.hpp"

namespace kiloband::faults {
namespace {

TEST(FaultTable, NumbersAreTheEnumeration) {
  uint32_t number = KB_PLANTED_NONE;
  for (const PlantedFault& fault : planted_faults()) EXPECT_EQ(fault.number, ++number) << fault.name;
  EXPECT_EQ(number + 1, static_cast<uint32_t>(KB_PLANTED_COUNT));
}

TEST(FaultTable, EntriesAreComplete) {
  std::set<std::string_view> names;
  for (const PlantedFault& fault : planted_faults()) {
    EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
    EXPECT_EQ(fault.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz-"), std::string_view::npos);
    EXPECT_FALSE(fault.description.empty() || fault.needs.empty() || fault.caught_by.empty()) << fault.name;
    EXPECT_TRUE(fault.where == kShared || (fault.where & ~uint32_t{kBoth}) == 0) << fault.name;
    EXPECT_NO_THROW(test::zoo_scene(std::string(fault.zoo_scene))) << fault.name;
  }
}

TEST(FaultSelection, SelectsOnePlaceAndRestores) {
  EXPECT_EQ(selected_fault(), "none");
  {
    const FaultScope outer("cpu:missing-cosine");
    EXPECT_TRUE(KB_PLANTED(COSINE));
    EXPECT_FALSE(KB_PLANTED_OPENCL(COSINE) || KB_PLANTED_SHARED(COSINE) || KB_PLANTED(LIGHT_PDF));
    {
      const FaultScope inner("shared:triangle-warp");
      EXPECT_EQ(selected_fault(), "shared:triangle-warp");
      EXPECT_TRUE(KB_PLANTED_SHARED(TRIANGLE_WARP));
      EXPECT_FALSE(KB_PLANTED(COSINE));
    }
    EXPECT_EQ(selected_fault(), "cpu:missing-cosine");
  }
  EXPECT_EQ(selected_fault(), "none");
}

std::string message_of(const std::string& text) {
  return test::error_of<std::invalid_argument>([&] { select_fault(text); });
}

TEST(FaultSelection, RefusesWhatThereIsNot) {
  EXPECT_EQ(message_of("missing-cosine"),
            "fault 'missing-cosine': must be none, or cpu:, opencl: or shared: and a name of "
            "validation/faults/table.cpp");
  EXPECT_EQ(message_of("cpu:no-such"),
            "fault 'cpu:no-such': must be none, or cpu:, opencl: or shared: and a name of "
            "validation/faults/table.cpp");
  EXPECT_EQ(message_of("cpu:triangle-warp"),
            "fault 'cpu:triangle-warp': there is none of that name in 'cpu'");
  EXPECT_EQ(selected_fault(), "none");
}

/// A fault whose code does not compile would be a program that fails to build, not a wrong image.
TEST(FaultKernels, CompileWithEachFault) {
  for (const PlantedFault& fault : planted_faults()) {
    for (const std::string kernel :
         {"path/paths", "evaluate/evaluate", "evaluate/pt", "evaluate/resample", "film/film"}) {
      EXPECT_EQ(test::kernel_syntax(KILOBAND_SOURCE_DIR "/kernels/" + kernel + ".cl",
                                    "-DKB_PLANTED_SELECTED=" + std::to_string(fault.number)),
                "")
          << kernel << " with " << fault.name;
    }
  }
}

}  // namespace
}  // namespace kiloband::faults
