// <integrator type="moment">.
#include <gtest/gtest.h>

#include "support.hpp"

namespace kiloband::test {
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
            "scene.xml:2:19: note: moment integrator: read as the integrator in it: second moments are not "
            "written, --variance writes the variance of the mean");
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
        "scene.xml:2:45: error: integrator type 'aov' is not supported"},
       {"wrong value", moment(R"(<integrator type="path"><integer name="rr_depth" value="0"/></integrator>)"),
        "scene.xml:2:83: error: path integrator: rr_depth 0: must be >= 1"},
       {"parameter", moment(R"(<integrator type="path"/><integer name="max_depth" value="3"/>)"),
        "scene.xml:2:67: error: moment integrator: unknown parameter 'max_depth'"}});
}

}  // namespace
}  // namespace kiloband::test
