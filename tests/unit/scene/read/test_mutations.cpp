// Damaged scenes: reading returns or throws InputError, never anything else.
#include <gtest/gtest.h>

#include "support.hpp"
#include "tests/support/mutations.hpp"

namespace kiloband::test::test_mutations {
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

TEST(SceneMutations, DamagedScenesAreReadOrRefused) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("part.xml",
               "<scene version=\"3.0.0\"><shape type=\"rectangle\"><ref id=\"leaf\"/></shape></scene>");
  const std::vector<std::string> words{"<",
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
                                       ",",
                                       "-1",
                                       "0",
                                       "99999999999999999999",
                                       "\xC3",
                                       "<shape type=\"sphere\"/>",
                                       "<ref id=\"leaf\"/>",
                                       "</scene>",
                                       "<scene version=\"0.1\">",
                                       "<include filename=\"part.xml\"/>"};
  // A tenth is accepted: otherwise the damage is too coarse to reach the readers.
  expect_robust(kScene, {.times = 3000, .most_changes = 2, .words = words}, 0.1,
                [&](const std::string& mutant) {
                  const std::string message = error_of(mutant, folder);
                  if (message == "accepted") return;
                  EXPECT_TRUE(message.starts_with("scene.xml:")) << message << "\n" << mutant;
                  throw InputError(message);
                });
}

}  // namespace
}  // namespace kiloband::test::test_mutations
