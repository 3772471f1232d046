// Damaged scenes: reading returns or throws InputError, never anything else.
#include <gtest/gtest.h>

#include <random>

#include "support.hpp"

namespace kiloband::test {
namespace {

const std::string kScene = R"(<scene version="3.0.0">
<default name="n" value="8"/><alias id="leaf" as="grass"/>
<integrator type="path"><integer name="max_depth" value="$n"/></integrator>
<sensor type="thinlens"><float name="aperture_radius" value="0.1"/><float name="fov" value="45"/>
<transform name="to_world"><lookat origin="0 0 5" target="0,0,0" up="0 1 0"/><rotate y="1" angle="30"/></transform>
<sampler type="stratified"><integer name="sample_count" value="16"/></sampler>
<film type="specfilm"><integer name="width" value="$n"/><integer name="height" value="6"/>
<spectrum name="a" value="400:1 410:1"/><spectrum name="b" value="500:0 510:1 520:0"/><rfilter type="tent"/></film></sensor>
<bsdf type="twosided" id="leaf"><bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.1 0.4 0.2"/>
<float name="alpha" value="0.2"/><string name="int_ior" value="water"/></bsdf></bsdf>
<shape type="sphere"><point name="center" x="0" y="1" z="0"/><ref id="grass"/></shape>
<shape type="obj"><string name="filename" value="a.obj"/><transform name="to_world"><scale value="2"/>
<matrix value="1 0 0 1 0 1 0 1 0 0 1 1 0 0 0 1"/></transform><emitter type="area">
<spectrum name="radiance" value="400:1, 500:2, 700:0.5"/></emitter></shape>
<include filename="part.xml"/>
<emitter type="spot"><spectrum type="blackbody" name="intensity"><float name="temperature" value="5000"/></spectrum>
</emitter></scene>
)";

/// Another digit somewhere: leaves the syntax whole, so that the readers of entities are reached.
void change_digit(std::string& text, std::size_t from, char digit) {
  const std::size_t at = text.find_first_of("0123456789", from);
  if (at != std::string::npos) text[at] = digit;
}

/// One to three edits: a byte changed, a span removed, a span copied elsewhere, a word of the grammar
/// inserted, a digit or two changed, a line removed.
std::string mutate(std::string text, std::mt19937& random) {
  static const std::vector<std::string> kWords = {"<",
                                                  ">",
                                                  "/>",
                                                  "\"",
                                                  "&",
                                                  "&#0;",
                                                  "$",
                                                  "\\$",
                                                  "-",
                                                  "1e309",
                                                  "nan",
                                                  ":",
                                                  "<shape type=\"sphere\"/>",
                                                  "<ref id=\"leaf\"/>",
                                                  "</scene>",
                                                  "<scene version=\"0.1\">",
                                                  "<include filename=\"part.xml\"/>",
                                                  "99999999999999999999",
                                                  "-1",
                                                  "0",
                                                  ",",
                                                  "\xC3"};
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (std::size_t edits = 1 + below(3); edits > 0 && !text.empty(); --edits) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(1 + below(30), text.size() - at);
    switch (below(8)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      case 3:
      case 4:
      case 5:
        change_digit(text, at, static_cast<char>('0' + below(10)));
        break;
      case 6: {
        const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
        text.erase(text.rfind('\n', at) + 1, end - text.rfind('\n', at));
        break;
      }
      default:
        text.insert(at, kWords[below(kWords.size())]);
        break;
    }
  }
  return text;
}

TEST(SceneMutations, DamagedScenesAreReadOrRefused) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("part.xml",
               "<scene version=\"3.0.0\"><shape type=\"rectangle\"><ref id=\"leaf\"/></shape></scene>");
  ASSERT_EQ(error_of(kScene, folder.path()), "accepted");
  std::mt19937 random(20240611);
  int accepted = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string text = mutate(kScene, random);
    try {
      read(text, folder.path());
      ++accepted;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find("scene.xml:"), 0u) << error.what() << "\n" << text;
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << "\n" << text;
    }
  }
  EXPECT_GT(accepted, 300);  // otherwise the mutations are too coarse to reach the readers
  EXPECT_LT(accepted, 2700);
}

}  // namespace
}  // namespace kiloband::test
