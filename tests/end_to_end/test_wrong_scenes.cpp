// Broken scenes through the whole program: syntax, values, what a scene needs.
// tests/unit/scene/read has more of each kind.
#include <gtest/gtest.h>

#include "tests/end_to_end/support/wrong_input.hpp"

namespace kiloband::test {
namespace {

/// A complete scene with a diffuse bsdf 'leaf' in line 2 that holds `parameter`.
std::string leaf(const std::string& parameter) {
  return complete_scene(R"xml(<bsdf type="diffuse" id="leaf">)xml" + parameter + "</bsdf>");
}

TEST(WrongScene, Syntax) {
  const TemporaryFolder folder;
  expect_refused(
      folder,
      std::vector<WrongScene>{
          {"empty file", "", "broken.xml:1:1: error: no root element"},
          {"not XML", "hello", "broken.xml:1:1: error: text between elements is not allowed"},
          {"end tag missing", "<scene version=\"3.0.0\">\n<shape type=\"sphere\">\n</scene>\n",
           "broken.xml:3:3: error: not well-formed XML: Start-end tags mismatch"},
          {"binary", "\x01", "broken.xml:1:1: error: control character with code 1 is not allowed in XML"},
          {"no version", "<scene>\n</scene>\n",
           "broken.xml:1:2: error: <scene>: attribute 'version' is missing"},
          {"version of the future", "<scene version=\"9.0.0\">\n</scene>\n",
           "broken.xml:1:17: error: version 9.0.0 is not supported (at most 3)"},
          {"another root", "<mesh version=\"3.0.0\"/>\n",
           "broken.xml:1:2: error: the root element must be <scene>, found <mesh>"},
          {"unquoted attribute", complete_scene(R"xml(<bsdf type=diffuse/>)xml"),
           "broken.xml:2:12: error: not well-formed XML: Error parsing element attribute"},
          {"unknown entity", complete_scene(R"xml(<bsdf type="&diff;"/>)xml"),
           "broken.xml:2:13: error: unknown entity '&diff'"},
          {"text between elements", complete_scene(R"xml(<bsdf type="diffuse"/> grey)xml"),
           "broken.xml:2:24: error: text between elements is not allowed"},
          {"unknown element", complete_scene(R"xml(<material type="diffuse"/>)xml"),
           "broken.xml:2:2: error: unknown element <material>"},
          {"unknown bsdf type", complete_scene(R"xml(<bsdf type="difuse"/>)xml"),
           "broken.xml:2:13: error: bsdf type 'difuse' is not supported; did you mean 'diffuse'?"},
          {"unknown film type",
           scene_text(R"xml(<sensor type="perspective"><film type="ldrfilm"/></sensor>)xml" + kLight +
                      kSphere),
           "broken.xml:2:40: error: film type 'ldrfilm' is not supported; did you mean 'hdrfilm'?"},
          {"unknown attribute", leaf(R"xml(<float name="reflectance" val="0.1"/>)xml"),
           "broken.xml:2:58: error: <float>: unknown attribute 'val'"},
          {"cyclic reference", complete_scene(R"xml(<bsdf type="mask" id="a"><ref id="b"/></bsdf>
<bsdf type="mask" id="b"><ref id="a"/></bsdf>)xml"),
           "broken.xml:3:35: error: reference 'a' to an object that contains it"},
          {"reference to nothing",
           complete_scene(
               R"xml(<shape type="sphere"><ref id="lea"/></shape><bsdf type="diffuse" id="leaf"/>)xml"),
           "broken.xml:2:31: error: no object has the id 'lea'; did you mean 'leaf'?"},
          {"id taken", complete_scene(R"xml(<bsdf type="diffuse" id="a"/>
<bsdf type="plastic" id="a"/>)xml"),
           "broken.xml:3:26: error: id 'a' is taken: first used at broken.xml:2:26"},
          {"undefined variable", leaf(R"xml(<float name="reflectance" value="$grey"/>)xml"),
           "broken.xml:2:65: error: parameter '$grey' is not defined (neither by <default> nor by -D)"},
      });
}

TEST(WrongScene, Values) {
  const TemporaryFolder folder;
  expect_refused(
      folder,
      std::vector<WrongScene>{
          {"unknown parameter", leaf(R"xml(<float name="reflectence" value="0.1"/>)xml"),
           "broken.xml:2:45: error: bsdf 'leaf': unknown parameter 'reflectence'; did you mean "
           "'reflectance'?"},
          {"wrong type",
           complete_scene(R"xml(<bsdf type="roughconductor"><string name="alpha" value="0.1"/></bsdf>)xml"),
           "broken.xml:2:57: error: roughconductor bsdf: parameter 'alpha': expected a float, found a "
           "string"},
          {"parameter given twice",
           leaf(R"xml(<float name="reflectance" value="0.1"/><float name="reflectance" value="0.2"/>)xml"),
           "broken.xml:2:84: error: bsdf 'leaf': parameter 'reflectance' is given twice"},
          {"NaN radius",
           complete_scene(R"xml(<shape type="sphere"><float name="radius" value="nan"/></shape>)xml"),
           "broken.xml:2:50: error: sphere shape: radius: 'nan' is not finite"},
          {"infinite translation",
           complete_scene(
               R"xml(<shape type="sphere"><transform name="to_world"><translate x="inf"/></transform></shape>)xml"),
           "broken.xml:2:63: error: 'inf' is not finite"},
          {"NaN in a spectrum", leaf(R"xml(<spectrum name="reflectance" value="400:0.1, 500:nan"/>)xml"),
           "broken.xml:2:68: error: bsdf 'leaf': reflectance: 'nan' is not finite"},
          {"reflectance above 1", leaf(R"xml(<spectrum name="reflectance" value="400:0.5, 550:1.27"/>)xml"),
           "broken.xml:2:68: error: bsdf 'leaf': reflectance 1.27 at 550 nm: must be in [0, 1]"},
          {"negative reflectance", leaf(R"xml(<spectrum name="reflectance" value="400:-0.5, 550:1"/>)xml"),
           "broken.xml:2:68: error: bsdf 'leaf': reflectance -0.5 at 400 nm: must be in [0, 1]"},
          {"flat reflectance above 1", leaf(R"xml(<float name="reflectance" value="1.5"/>)xml"),
           "broken.xml:2:65: error: bsdf 'leaf': reflectance 1.5: must be in [0, 1]"},
          {"colour above 1", leaf(R"xml(<rgb name="reflectance" value="0.5, 2, 0"/>)xml"),
           "broken.xml:2:63: error: bsdf 'leaf': reflectance rgb component 2: must be in [0, 1]"},
          {"wavelengths descend", leaf(R"xml(<spectrum name="reflectance" value="500:0.5, 400:0.5"/>)xml"),
           "broken.xml:2:68: error: bsdf 'leaf': reflectance: wavelength 400 nm after 500 nm: must increase "
           "strictly"},
          {"wavelength repeated", leaf(R"xml(<spectrum name="reflectance" value="500:0.5, 500:0.6"/>)xml"),
           "broken.xml:2:68: error: bsdf 'leaf': reflectance: wavelength 500 nm after 500 nm: must increase "
           "strictly"},
          {"negative radiance",
           scene_text(
               R"xml(<emitter type="constant"><spectrum name="radiance" value="400:1 500:-2"/></emitter>)xml" +
               kSensor),
           "broken.xml:2:59: error: constant emitter: radiance -2 at 500 nm: must be >= 0"},
          {"temperature below 0",
           scene_text(
               R"xml(<emitter type="constant"><spectrum type="planck" name="radiance"><float name="temperature" value="-3"/></spectrum></emitter>)xml" +
               kSensor),
           "broken.xml:2:99: error: planck spectrum: temperature -3: must be >= 0 K"},
          {"singular transform",
           complete_scene(
               R"xml(<shape type="cube"><transform name="to_world"><scale z="0"/></transform></shape>)xml"),
           "broken.xml:2:21: error: transform 'to_world' is singular"},
          {"index of refraction 0",
           complete_scene(R"xml(<bsdf type="dielectric"><float name="int_ior" value="0"/></bsdf>)xml"),
           "broken.xml:2:54: error: dielectric bsdf: int_ior 0: must be > 0"},
          {"unknown metal",
           complete_scene(R"xml(<bsdf type="conductor"><string name="metal" value="Auu"/></bsdf>)xml"),
           "broken.xml:2:52: error: conductor bsdf: metal: 'Auu' is neither a built-in metal nor a file; "
           "did you mean 'Au'?"},
      });
}

TEST(WrongScene, WholeScene) {
  const TemporaryFolder folder;
  expect_refused(
      folder,
      std::vector<WrongScene>{
          {"no sensor", scene_text(kLight + kSphere), "broken.xml:1:2: error: scene: has no sensor"},
          {"two sensors", complete_scene(kSensor),
           "broken.xml:3:2: error: scene: a second sensor: only one is supported"},
          {"no light", scene_text(kSensor + kSphere), "broken.xml:1:2: error: scene: has no emitter"},
          {"nothing to see", scene_text(kSensor + R"xml(<emitter type="point"/>)xml"),
           "broken.xml:1:2: error: scene: has neither a shape nor an environment"},
          {"two environments", complete_scene(kLight),
           "broken.xml:3:133: error: constant emitter: a second environment: only one is allowed"},
          {"film of 0 pixels",
           scene_text(
               R"xml(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="0"/></film></sensor>)xml" +
               kLight + kSphere),
           "broken.xml:2:78: error: hdrfilm film: width 0: must be from 1 to 65535"},
          {"film too large",
           scene_text(
               R"xml(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="100000"/></film></sensor>)xml" +
               kLight + kSphere),
           "broken.xml:2:78: error: hdrfilm film: width 100000: must be from 1 to 65535"},
          {"crop outside the film",
           scene_text(
               R"xml(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/><integer name="crop_width" value="9"/></film></sensor>)xml" +
               kLight + kSphere),
           "broken.xml:2:150: error: hdrfilm film: crop_width 9: must be from 1 to 8"},
          {"no channels in the film",
           scene_text(
               R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands" value="400:700:0"/></film></sensor>)xml" +
               kLight + kSphere),
           "broken.xml:2:78: error: bands '400:700:0': count '0': must be a whole number from 1"},
          {"reversed channel in the film",
           scene_text(
               R"xml(<sensor type="perspective"><film type="bandfilm"><string name="bands" value="400-500, 600-550"/></film></sensor>)xml" +
               kLight + kSphere),
           "broken.xml:2:78: error: bands '400-500, 600-550': '600-550': the interval is reversed: 600 nm is "
           "above 550 nm"},
          {"field of view of 180 degrees",
           scene_text(R"xml(<sensor type="perspective"><float name="fov" value="180"/></sensor>)xml" +
                      kLight + kSphere),
           "broken.xml:2:53: error: perspective sensor: fov 180: must be between 0 and 180 degrees"},
          {"samples per pixel 0",
           scene_text(
               R"xml(<sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="0"/></sampler></sensor>)xml" +
               kLight + kSphere),
           "broken.xml:2:92: error: independent sampler: sample_count 0: must be >= 1"},
          {"medium", complete_scene(R"xml(<medium type="homogeneous"/>)xml"),
           "broken.xml:2:15: error: medium type 'homogeneous' is not supported"},
      });
}

}  // namespace
}  // namespace kiloband::test
