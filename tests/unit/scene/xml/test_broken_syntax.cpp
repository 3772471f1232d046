// Broken scenes with the exact message and position: XML, includes, parameters, references, plain values.
#include <gtest/gtest.h>

#include "tests/unit/scene/read/support.hpp"

namespace kiloband::test::test_broken_syntax {
namespace {

/// `depth` nested elements around nothing.
std::string deep_scene(int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += "<bsdf type=\"mask\">";
  for (int i = 0; i < depth; ++i) text += "</bsdf>";
  return complete_scene(text);
}

/// Scenes begin in line 2: see scene() and complete_scene().
std::vector<BrokenScene> table() {
  return {
      {"empty file", R"xml()xml", "scene.xml:1:1: error: no root element"},
      {"truncated", R"xml(<scene version="3.0.0">
  <bsdf type="diffuse")xml",
       "scene.xml:2:15: error: not well-formed XML: Error parsing element attribute"},
      {"unclosed element", R"xml(<scene version="3.0.0">
  <bsdf type="diffuse">
</scene>)xml",
       "scene.xml:3:3: error: not well-formed XML: Start-end tags mismatch: <bsdf> of line 2 is not closed"},
      {"unclosed root", R"xml(<scene version="3.0.0"><!-- <a> -->
  <bsdf type="a>b"><float name='x' value="/"/></bsdf>
)xml",
       "scene.xml:2:54: error: not well-formed XML: Start-end tags mismatch: <scene> of line 1 is not closed"},
      {"wrong root", R"xml(<bsdf type="diffuse"/>)xml",
       "scene.xml:1:2: error: the root element must be <scene>, found <bsdf>"},
      {"two roots", R"xml(<scene version="3.0.0"/>
 <scene version="3.0.0"/>)xml",
       "scene.xml:2:3: error: a second root element <scene>"},
      {"text between elements", complete_scene(R"xml(<bsdf type="diffuse">
  hello
</bsdf>)xml"),
       "scene.xml:3:3: error: text between elements is not allowed"},
      {"cdata", complete_scene(R"xml(<bsdf type="diffuse"><![CDATA[x]]></bsdf>)xml"),
       "scene.xml:2:31: error: text between elements is not allowed"},
      {"doctype", R"xml(<!DOCTYPE scene>
<scene version="3.0.0"/>)xml",
       "scene.xml:1:11: error: document type declarations are not supported"},
      {"encoding", R"xml(<?xml version="1.0" encoding="latin-1"?>
<scene version="3.0.0"/>)xml",
       "scene.xml:1:31: error: encoding 'latin-1' is not supported: use UTF-8"},
      {"bad UTF-8",
       "<scene version=\"3.0.0\">\n<!-- \xFF"
       " -->\n</scene>",
       "scene.xml:2:6: error: not valid UTF-8"},
      {"NUL byte", std::string("<scene\0version=\"3.0.0\"/>", 24),
       "scene.xml:1:7: error: control character with code 0 is not allowed in XML"},
      {"control character", "\x01",
       "scene.xml:1:1: error: control character with code 1 is not allowed in XML"},
      {"text in front", "hello", "scene.xml:1:1: error: text between elements is not allowed"},
      {"unquoted attribute", complete_scene(R"xml(<bsdf type=diffuse/>)xml"),
       "scene.xml:2:12: error: not well-formed XML: Error parsing element attribute"},
      {"duplicate attribute", complete_scene(R"xml(<bsdf type="diffuse" id="a" type="plastic"/>)xml"),
       "scene.xml:2:29: error: attribute 'type' is given twice"},
      {"undefined entity", complete_scene(R"xml(<bsdf type="&glossy;"/>)xml"),
       "scene.xml:2:13: error: unknown entity '&glossy'"},
      {"less-than sign in a value", complete_scene(R"xml(<bsdf type="a<b"/>)xml"),
       "scene.xml:2:14: error: '<' in an attribute value: write &lt;"},
      {"unknown element", complete_scene(R"xml(<bsfd type="diffuse"/>)xml"),
       "scene.xml:2:2: error: unknown element <bsfd>; did you mean 'bsdf'?"},
      {"unknown element like no other", complete_scene(R"xml(<material type="diffuse"/>)xml"),
       "scene.xml:2:2: error: unknown element <material>"},
      {"unknown attribute of a value",
       complete_scene(R"xml(<bsdf type="diffuse"><float name="reflectance" val="0.1"/></bsdf>)xml"),
       "scene.xml:2:48: error: <float>: unknown attribute 'val'"},
      {"unknown attribute", complete_scene(R"xml(<bsdf type="diffuse" idd="a"/>)xml"),
       "scene.xml:2:22: error: <bsdf>: unknown attribute 'idd'; did you mean 'id'?"},
      {"missing attribute", complete_scene(R"xml(<bsdf id="a"/>)xml"),
       "scene.xml:2:2: error: <bsdf>: attribute 'type' is missing"},
      {"no version", R"xml(<scene/>)xml", "scene.xml:1:2: error: <scene>: attribute 'version' is missing"},
      {"bad version", R"xml(<scene version="three"/>)xml",
       "scene.xml:1:17: error: 'three' is not a version such as 3.0.0"},
      {"future version", R"xml(<scene version="4.0.0"/>)xml",
       "scene.xml:1:17: error: version 4.0.0 is not supported (at most 3)"},
      {"nested scene", complete_scene(R"xml(<scene version="3.0.0"/>)xml"),
       "scene.xml:2:2: error: <scene> is allowed as the root element only"},
      {"deep nesting", deep_scene(100), "scene.xml:2:1136: error: nested more than 64 levels deep"},
      {"value with children",
       complete_scene(
           R"xml(<bsdf type="diffuse"><float name="a" value="1"><float name="b" value="1"/></float></bsdf>)xml"),
       "scene.xml:2:49: error: <float> cannot contain elements"},
      {"step outside a transform", complete_scene(R"xml(<bsdf type="diffuse"><scale value="2"/></bsdf>)xml"),
       "scene.xml:2:23: error: <scale> is allowed in a transform only"},
      {"value inside a transform",
       complete_scene(
           R"xml(<shape type="disk"><transform name="to_world"><float name="a" value="1"/></transform></shape>)xml"),
       "scene.xml:2:48: error: <float> is not allowed in a transform"},
      {"reserved name",
       complete_scene(R"xml(<bsdf type="diffuse"><float name="_arg_0" value="1"/></bsdf>)xml"),
       "scene.xml:2:35: error: names starting with '_' are reserved"},
      {"undefined parameter",
       complete_scene(R"xml(<default name="width" value="8"/><bsdf type="$widht"/>)xml"),
       "scene.xml:2:46: error: parameter '$widht' is not defined (neither by <default> nor by -D); did you "
       "mean 'width'?"},
      {"undefined parameter like no other", complete_scene(R"xml(<bsdf type="$grey"/>)xml"),
       "scene.xml:2:13: error: parameter '$grey' is not defined (neither by <default> nor by -D)"},
      {"dollar without name", complete_scene(R"xml(<bsdf type="5$"/>)xml"),
       "scene.xml:2:13: error: '$' without a parameter name: write \\$ for the sign itself"},
      {"default without a proper name", complete_scene(R"xml(<default name="a-b" value="8"/>)xml"),
       "scene.xml:2:16: error: 'a-b' is not a parameter name"},
      {"exponential substitution", complete_scene(R"xml(<default name="a" value="0123456789"/>
<default name="b" value="$a$a$a$a$a$a$a$a$a$a$a$a$a$a$a$a"/>
<default name="c" value="$b$b$b$b$b$b$b$b$b$b$b$b$b$b$b$b"/>
<default name="d" value="$c$c$c$c$c$c$c$c$c$c$c$c$c$c$c$c"/>
<default name="e" value="$d$d$d$d$d$d$d$d$d$d$d$d$d$d$d$d"/>
<default name="f" value="$e$e$e$e$e$e$e$e$e$e$e$e$e$e$e$e"/>
<default name="g" value="$f$f$f$f$f$f$f$f$f$f$f$f$f$f$f$f"/>
<default name="h" value="$g$g$g$g$g$g$g$g$g$g$g$g$g$g$g$g"/>)xml"),
       "scene.xml:8:26: error: too much text after substitution"},
      {"missing include", complete_scene(R"xml(<include filename="none.xml"/>)xml"),
       "scene.xml:2:20: error: file 'none.xml' not found"},
      {"include of itself", complete_scene(R"xml(<include filename="loop.xml"/>)xml"),
       "loop.xml:1:43: error: file 'loop.xml' includes itself"},
      {"include with an error", complete_scene(R"xml(<include filename="bad.xml"/>)xml"),
       "bad.xml:2:7: error: <bsdf>: unknown attribute 'typ'; did you mean 'type'?"},
      {"include of a folder", complete_scene(R"xml(<include filename="."/>)xml"),
       "scene.xml:2:20: error: '.' is not a regular file"},
      {"empty include name", complete_scene(R"xml(<include filename=""/>)xml"),
       "scene.xml:2:20: error: the file name is empty"},
      {"missing search folder", complete_scene(R"xml(<path value="nowhere"/>)xml"),
       "scene.xml:2:14: error: folder 'nowhere' not found"},
      {"nested path", complete_scene(R"xml(<bsdf type="diffuse"><path value="."/></bsdf>)xml"),
       "scene.xml:2:23: error: <path> is allowed directly under <scene> only"},
      {"duplicate id", complete_scene(R"xml(<bsdf type="diffuse" id="a"/>
<bsdf type="plastic" id="a"/>)xml"),
       "scene.xml:3:26: error: id 'a' is taken: first used at scene.xml:2:26"},
      {"undefined reference",
       complete_scene(
           R"xml(<bsdf type="diffuse" id="grass"/><shape type="disk"><ref id="gras"/></shape>)xml"),
       "scene.xml:2:62: error: no object has the id 'gras'; did you mean 'grass'?"},
      {"cyclic reference", complete_scene(R"xml(<bsdf type="mask" id="a"><ref id="b"/></bsdf>
<bsdf type="mask" id="b"><ref id="a"/></bsdf>)xml"),
       "scene.xml:3:35: error: reference 'a' to an object that contains it"},
      {"cyclic alias", complete_scene(R"xml(<alias id="a" as="b"/><alias id="b" as="a"/>)xml"),
       "scene.xml:2:12: error: alias 'a' refers to itself"},
      {"alias of nothing", complete_scene(R"xml(<alias id="a" as="b"/>)xml"),
       "scene.xml:2:12: error: no object has the id 'a'"},
      {"alias of a taken id", complete_scene(R"xml(<bsdf type="diffuse" id="a"/><alias id="a" as="a"/>)xml"),
       "scene.xml:2:48: error: id 'a' is taken: first used at scene.xml:2:26"},
      {"parameter given twice",
       complete_scene(
           R"xml(<bsdf type="diffuse"><float name="reflectance" value="0.1"/><float name="reflectance" value="0.2"/></bsdf>)xml"),
       "scene.xml:2:74: error: diffuse bsdf: parameter 'reflectance' is given twice"},
      {"unknown parameter", complete_scene(R"xml(<bsdf type="diffuse" id="leaf">
  <float name="reflectence" value="0.1"/>
</bsdf>)xml"),
       "scene.xml:3:16: error: bsdf 'leaf': unknown parameter 'reflectence'; did you mean 'reflectance'?"},
      {"wrong type",
       complete_scene(R"xml(<bsdf type="roughconductor"><string name="alpha" value="0.1"/></bsdf>)xml"),
       "scene.xml:2:57: error: roughconductor bsdf: parameter 'alpha': expected a float, found a string"},
      {"float for an integer",
       complete_scene(R"xml(<integrator type="path"><float name="max_depth" value="3"/></integrator>)xml"),
       "scene.xml:2:56: error: path integrator: parameter 'max_depth': expected an integer, found a float"},
      {"fraction for an integer",
       complete_scene(
           R"xml(<integrator type="path"><integer name="max_depth" value="3.5"/></integrator>)xml"),
       "scene.xml:2:58: error: path integrator: max_depth: '3.5' is not an integer"},
      {"integer out of range",
       complete_scene(
           R"xml(<integrator type="path"><integer name="max_depth" value="99999999999999999999"/></integrator>)xml"),
       "scene.xml:2:58: error: path integrator: max_depth: '99999999999999999999' is outside the range of "
       "integers"},
      {"not a number",
       complete_scene(R"xml(<bsdf type="roughconductor"><float name="alpha" value="0.1x"/></bsdf>)xml"),
       "scene.xml:2:56: error: roughconductor bsdf: alpha: '0.1x' is not a number"},
      {"NaN", complete_scene(R"xml(<bsdf type="roughconductor"><float name="alpha" value="nan"/></bsdf>)xml"),
       "scene.xml:2:56: error: roughconductor bsdf: alpha: 'nan' is not finite"},
      {"infinity", complete_scene(R"xml(<shape type="sphere"><float name="radius" value="inf"/></shape>)xml"),
       "scene.xml:2:50: error: sphere shape: radius: 'inf' is not finite"},
      {"infinite translation",
       complete_scene(
           R"xml(<shape type="cube"><transform name="to_world"><translate x="inf"/></transform></shape>)xml"),
       "scene.xml:2:61: error: 'inf' is not finite"},
      {"NaN in a spectrum",
       complete_scene(
           R"xml(<bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1, 500:nan"/></bsdf>)xml"),
       "scene.xml:2:58: error: diffuse bsdf: reflectance: 'nan' is not finite"},
      {"number out of range",
       complete_scene(R"xml(<shape type="sphere"><float name="radius" value="1e999"/></shape>)xml"),
       "scene.xml:2:50: error: sphere shape: radius: '1e999' is outside the range of numbers"},
      {"not a boolean",
       complete_scene(R"xml(<shape type="sphere"><boolean name="flip_normals" value="yes"/></shape>)xml"),
       "scene.xml:2:58: error: sphere shape: flip_normals: 'yes' is neither 'true' nor 'false'"},
      {"incomplete point",
       complete_scene(R"xml(<shape type="sphere"><point name="center" x="1" y="2"/></shape>)xml"),
       "scene.xml:2:23: error: sphere shape: center: <point> needs 'value' or all of 'x', 'y' and 'z'"},
      {"point with two numbers",
       complete_scene(R"xml(<shape type="sphere"><point name="center" value="1, 2"/></shape>)xml"),
       "scene.xml:2:50: error: sphere shape: center: expected 1 or 3 numbers, found 2"},
      {"point given in two ways",
       complete_scene(R"xml(<shape type="sphere"><point name="center" value="1, 2, 3" x="1"/></shape>)xml"),
       "scene.xml:2:23: error: sphere shape: center: <point> has both 'value' and coordinates"},
      {"value directly in the scene", complete_scene(R"xml(<float name="gamma" value="1"/>)xml"),
       "scene.xml:2:14: error: scene: unknown parameter 'gamma'"},
      {"unexpected nested object",
       complete_scene(R"xml(<shape type="sphere"><film type="hdrfilm"/></shape>)xml"),
       "scene.xml:2:23: error: sphere shape: a film is not allowed here"},
      {"spectrum without data",
       complete_scene(R"xml(<bsdf type="diffuse"><spectrum name="reflectance"/></bsdf>)xml"),
       "scene.xml:2:23: error: <spectrum> needs exactly one of the attributes 'value', 'filename' and "
       "'type'"},
  };
}

TEST(BrokenScenes, Syntax) {
  const TemporaryFolder folder;
  folder.write("loop.xml", "<scene version=\"3.0.0\"><include filename=\"loop.xml\"/></scene>");
  folder.write("bad.xml", "<scene version=\"3.0.0\">\n<bsdf typ=\"x\"/>\n</scene>");
  expect_messages(table(), folder);
}

}  // namespace
}  // namespace kiloband::test::test_broken_syntax
