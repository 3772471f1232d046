// Integrators around another: <integrator type="moment"> and <integrator type="aov">; those that are refused.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test::test_integrators {
namespace {

std::string moment(const std::string& inside) {
  return complete_scene(R"(<integrator type="moment">)" + inside + "</integrator>");
}

TEST(MomentIntegrator, IsReadAsTheIntegratorInIt) {
  Messages messages;
  const SceneDescription result = read(
      moment(
          R"(<integrator type="path" name="image"><integer name="max_depth" value="4"/><boolean name="hide_emitters" value="true"/></integrator>)"),
      "/nonexistent", {}, messages.lines());
  EXPECT_EQ(result.integrator.max_depth, 4);
  EXPECT_TRUE(result.integrator.hide_emitters);
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(messages.texts[0],
            "scene.xml:2:19: note: moment integrator: in place of second moments the variance of the mean is "
            "written (--variance)");
  EXPECT_TRUE(result.requested.variance);
  const SceneDescription direct = read(moment(
      R"(<integrator type="direct"><integer name="emitter_samples" value="3"/><integer name="bsdf_samples" value="1"/></integrator>)"));
  EXPECT_EQ(direct.integrator.max_depth, 2);
  EXPECT_EQ(direct.sensor.sample_count, 12u);  // 4 samples, 3 times as many paths
}

TEST(MomentIntegrator, RefusesWhatTheNestedOneWouldBeRefusedFor) {
  expect_messages(
      {{"empty", moment(""), "scene.xml:2:2: error: moment integrator: needs a nested integrator"},
       {"two", moment(R"(<integrator type="path"/><integrator type="direct"/>)"),
        "scene.xml:2:53: error: moment integrator: a second integrator"},
       {"unknown", moment(R"(<integrator type="aov"/>)"),
        "scene.xml:2:28: error: aov integrator: parameter 'aovs' is missing"},
       {"wrong value", moment(R"(<integrator type="path"><integer name="rr_depth" value="0"/></integrator>)"),
        "scene.xml:2:83: error: path integrator: rr_depth 0: must be >= 1"},
       {"parameter", moment(R"(<integrator type="path"/><integer name="max_depth" value="3"/>)"),
        "scene.xml:2:67: error: moment integrator: unknown parameter 'max_depth'"}});
}

std::string aov(const std::string& aovs, const std::string& inside = R"(<integrator type="path"/>)") {
  return complete_scene(R"(<integrator type="aov"><string name="aovs" value=")" + aovs + "\"/>" + inside +
                        "</integrator>");
}

using Names = std::vector<std::string>;

TEST(AovIntegrator, AsksForOurImagesOfTheSameContent) {
  Messages messages;
  const SceneDescription result =
      read(aov("dd.y:depth, nn:sh_normal id:shape_index,d2:depth",
               R"(<integrator type="path"><integer name="max_depth" value="4"/></integrator>)"),
           "/nonexistent", {}, messages.lines());
  EXPECT_EQ(result.requested.auxiliary, (Names{"depth", "normal", "object"}));
  EXPECT_EQ(result.integrator.max_depth, 4);
  EXPECT_FALSE(result.requested.variance);
  EXPECT_TRUE(messages.texts.empty());
  const SceneDescription both =
      read(aov("a:depth", R"(<integrator type="moment"><integrator type="direct"/></integrator>)"));
  EXPECT_TRUE(both.requested.variance);
  EXPECT_EQ(both.requested.auxiliary, Names{"depth"});
  EXPECT_EQ(both.integrator.max_depth, 2);
  const std::string inner = R"(<integrator type="aov"><string name="aovs" value="i:shape_index,d:depth"/>)";
  const SceneDescription nested =
      read(aov("a:depth,n:sh_normal", inner + R"(<integrator type="path"/></integrator>)"));
  EXPECT_EQ(nested.requested.auxiliary, (Names{"normal", "object", "depth"}));  // each once
}

TEST(AovIntegrator, NamesWhatIsNotWritten) {
  Messages messages;
  EXPECT_EQ(read(aov("a:albedo,b:depth,c:uv"), "/nonexistent", {}, messages.lines()).requested.auxiliary,
            Names{"depth"});
  ASSERT_EQ(messages.texts.size(), 1u);
  EXPECT_EQ(
      messages.texts[0],
      "scene.xml:2:51: note: aov integrator: no images of albedo, uv: there are depth, sh_normal, shape_index");
}

TEST(AovIntegrator, Errors) {
  expect_messages(
      {{"no type", aov("depth"),
        "scene.xml:2:51: error: aov integrator: aovs: 'depth' is not NAME:TYPE with a known type"},
       {"misspelt type", aov("a:dept"),
        "scene.xml:2:51: error: aov integrator: aovs: 'a:dept' is not NAME:TYPE with a known type; did you mean 'depth'?"}});
}

TEST(Integrators, WhatIsRefusedSaysWhatWorks) {
  expect_messages(
      {{"from the lights", complete_scene(R"(<integrator type="ptracer"/>)"),
        "scene.xml:2:19: error: integrator type 'ptracer' is not supported: paths begin at the camera here; "
        "'path' gives its image"},
       {"polarised", complete_scene(R"(<integrator type="stokes"><integrator type="path"/></integrator>)"),
        "scene.xml:2:19: error: integrator type 'stokes' is not supported: light has no polarisation here; "
        "'path' gives the first component without it"},
       {"unknown", complete_scene(R"(<integrator type="pth"/>)"),
        "scene.xml:2:19: error: integrator type 'pth' is not supported; did you mean 'path'?"}});
}

}  // namespace
}  // namespace kiloband::test::test_integrators
