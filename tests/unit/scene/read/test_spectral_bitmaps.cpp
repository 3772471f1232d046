// <texture type="spectral_bitmap"> with weights: parameters whose names are numbered.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_spectral_bitmaps {
namespace {

std::string wall(const std::string& parameters) {
  return complete_scene(
      R"(<shape type="rectangle"><bsdf type="diffuse"><texture type="spectral_bitmap" name="reflectance">)"
      R"(<string name="weights" value="w.ppm"/>)" +
      parameters + "</texture></bsdf></shape>");
}

std::string endmember(const std::string& name) {
  return "<float name=\"" + name + R"(" value="0.25"/>)";
}

/// One pixel with three weights.
void write_weights(const TemporaryFolder& folder) {
  folder.write("w.ppm", "P6\n1 1\n255\n" + std::string("\xff\x80\x40", 3));
}

TEST(SpectralBitmaps, NumberedEndmembersAreReadAndRemembered) {
  const TemporaryFolder folder;
  write_weights(folder);
  const std::string three = endmember("endmember_0") + endmember("endmember_1") + endmember("endmember_2");
  EXPECT_EQ(error_of(wall(three), folder), "accepted");
  EXPECT_EQ(error_of(wall(three + endmember("endmembr_12")), folder),
            "scene.xml:2:268: error: spectral_bitmap texture: unknown parameter 'endmembr_12'; did you mean "
            "'endmember_1'?");
}

TEST(SpectralBitmaps, EndmembersAndWeightsAreEqualInNumber) {
  const TemporaryFolder folder;
  write_weights(folder);
  std::string many;
  for (int i = 0; i < 5; ++i) many += endmember("endmember_" + std::to_string(i));
  const std::string rule = " endmembers (endmember_0 ...) for 3 weights of 'w.ppm'";
  EXPECT_EQ(error_of(wall(endmember("endmember_0")), folder),
            "scene.xml:2:127: error: spectral_bitmap texture: 1" + rule);
  EXPECT_EQ(error_of(wall(many), folder), "scene.xml:2:127: error: spectral_bitmap texture: 5" + rule);
}

}  // namespace
}  // namespace kiloband::test::test_spectral_bitmaps
