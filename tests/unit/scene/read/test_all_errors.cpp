// All that is wrong with a scene at once: one error per place, and none that only follows from another.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/scene/read/support.hpp"

namespace kiloband::test::test_all_errors {
namespace {

TEST(AllErrors, OfSeveralObjects) {
  EXPECT_EQ(
      error_of(complete_scene(R"xml(<bsdf type="diffuse" id="a"><float name="reflectance" value="1.5"/></bsdf>
<bsdf type="velvet" id="b"/>
<shape type="ply"><string name="filename" value="absent.ply"/></shape>
<shape type="sphere"><float name="radius" value="-1"/></shape>)xml")),
      "scene.xml:2:62: error: bsdf 'a': reflectance 1.5: must be in [0, 1]\n"
      "scene.xml:3:13: error: bsdf type 'velvet' is not supported\n"
      "scene.xml:4:50: error: file 'absent.ply' not found\n"
      "scene.xml:5:50: error: sphere shape: radius -1: must be > 0");
}

TEST(AllErrors, OfOneObjectAndItsParts) {
  EXPECT_EQ(error_of(complete_scene(R"xml(<shape type="sphere">
<float name="radius" value="-1"/>
<point name="center" value="1, x, 3"/>
<bsdf type="roughplastic">
<float name="alpha" value="-2"/>
<string name="distribution" value="gauss"/>
</bsdf>
<emitter type="area"><rgb name="radiance" value="-1"/></emitter>
<float name="radios" value="1"/>
</shape>)xml")),
            "scene.xml:3:29: error: sphere shape: radius -1: must be > 0\n"
            "scene.xml:4:29: error: sphere shape: center: 'x' is not a number\n"
            "scene.xml:6:28: error: roughplastic bsdf: alpha -2: must be > 0\n"
            "scene.xml:7:36: error: roughplastic bsdf: distribution 'gauss': must be one of beckmann, ggx\n"
            "scene.xml:9:50: error: area emitter: radiance rgb component -1: must be >= 0\n"
            "scene.xml:10:14: error: sphere shape: unknown parameter 'radios'; did you mean 'radius'?");
}

TEST(AllErrors, WhatOthersReferToIsReportedOnce) {
  EXPECT_EQ(error_of(complete_scene(R"xml(<bsdf type="plastic" id="p"><float name="int_ior" value="0"/></bsdf>
<shape type="sphere"><ref id="p"/></shape>
<shape type="sphere"><ref id="p"/><float name="radius" value="0"/></shape>)xml")),
            "scene.xml:2:58: error: bsdf 'p': int_ior 0: must be > 0\n"
            "scene.xml:4:63: error: sphere shape: radius 0: must be > 0");
}

TEST(AllErrors, WhatIsMissingBecauseItWasWrongIsNone) {
  // Left out, the file name is missing; that is no second error.
  EXPECT_EQ(
      error_of(complete_scene(R"xml(<shape type="obj"><integer name="filename" value="1"/></shape>)xml")),
      "scene.xml:2:51: error: obj shape: parameter 'filename': expected a string, found an integer");
}

TEST(AllErrors, EndAfterTwenty) {
  std::string body;
  for (int i = 0; i < 30; ++i) body += R"xml(<shape type="cone"/>)xml" + std::string("\n");
  const std::string text = error_of(complete_scene(body));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 20);
  EXPECT_TRUE(text.starts_with("scene.xml:2:14: error: shape type 'cone' is not supported")) << text;
  EXPECT_TRUE(text.ends_with("\n(the first 20 errors; there may be more)")) << text;
}

}  // namespace
}  // namespace kiloband::test::test_all_errors
