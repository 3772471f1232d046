// kiloband trace: one path on either backend; and options that say which backend and how much memory.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;

Names trace(const Names& more) {
  Names arguments{"trace", cornell_box(), "--size", "16x16", "--bands", "400:700:4"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// The words of the lines that begin with `word`, without their numbers.
std::string skeleton(const std::string& text) {
  std::string kept;
  for (std::size_t at = text.find('\n') + 1; at < text.size();) {  // after the line that names the backend
    const std::size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    kept += line.substr(0, line.find("  t "));
    kept += '\n';
    at = end + 1;
  }
  kept.erase(std::remove_if(kept.begin(), kept.end(),
                            [](char c) { return std::isdigit(c) || c == '.' || c == '-'; }),
             kept.end());
  return kept;
}

/// Both backends follow one sequence of shapes, kinds and spectra: what parts them,
/// if anything does, is rounding.
TEST(Trace, BackendsAgree) {
  const TemporaryFolder folder;
  for (const std::string sample : {"0", "1", "17"}) {
    const Outcome cpu =
        run_program(folder, trace({"--pixel", "5,9", "--sample", sample, "--backend", "cpu"}));
    const Outcome opencl =
        run_program(folder, trace({"--pixel", "5,9", "--sample", sample, "--backend", "opencl"}));
    EXPECT_EQ(cpu.code, 0) << cpu.err;
    EXPECT_EQ(opencl.code, 0) << opencl.err;
    const std::string begin = "pixel 5,9 sample " + sample;
    EXPECT_EQ(cpu.out.rfind(begin, 0), 0u) << cpu.out;
    EXPECT_EQ(opencl.out.rfind(begin, 0), 0u) << opencl.out;
    EXPECT_NE(cpu.out.find("bounce 0   shape "), std::string::npos) << cpu.out;
    EXPECT_EQ(skeleton(cpu.out), skeleton(opencl.out));
  }
}

/// Gas: null boundaries are no bounces, and every segment in a gas is a vertex, a plume's with its cells.
TEST(Trace, GasAlongThePath) {
  const TemporaryFolder folder;
  folder.write("gas.xml", R"(<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="1"/>
<transform name="to_world"><lookat origin="0, 0, 9" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<medium type="absorbing" name="atmosphere" id="air"><spectrum name="absorption" value="0.1"/></medium>
<shape type="cube"><bsdf type="null"/><medium type="plume" name="interior" id="smoke">
<spectrum name="absorption" value="2"/><float name="temperature" value="2000"/><float name="ambient" value="300"/>
<float name="radius" value="0.3"/><float name="length" value="2"/></medium></shape>
<shape type="rectangle"><transform name="to_world"><translate z="-3"/></transform></shape>
<emitter type="point"><point name="position" value="0, 0, -1.5"/></emitter></scene>)");
  std::vector<std::string> outputs;
  for (const std::string backend : {"cpu", "opencl"}) {
    const Outcome outcome = run_program(folder, {"trace", "gas.xml", "--size", "16x16", "--bands",
                                                 "3000:5000:4", "--pixel", "8,8", "--backend", backend});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    for (const std::string text : {"\nboundary   shape 0 ", "\nbounce 0   shape 1 ",
                                   "\nvertex     gas, medium 'air': absorption\n  column   ",
                                   "\nvertex     gas, medium 'smoke': absorption\n  column   ",
                                   "\n  cells    ", ", through gas\n", "\n  light    through a column of "})
      EXPECT_NE(outcome.out.find(text), std::string::npos) << text << outcome.out;
    outputs.push_back(skeleton(outcome.out));
  }
  EXPECT_EQ(outputs[0], outputs[1]);
}

TEST(Trace, WrongPixels) {
  const TemporaryFolder folder;
  std::vector<WrongCommand> cases;
  for (const std::string pixel : {"5", "5,", ",5", "5,6,7", "5;6", "-1,2", "1.5,2", "a,b", "4294967296,0"})
    cases.push_back({{"--pixel=" + pixel}, "--pixel " + pixel + ": must be X,Y with whole numbers from 0"});
  for (const std::string pixel : {"16,0", "0,16"})
    cases.push_back({{"--pixel", pixel}, "--pixel " + pixel + ": the film has 16 x 16 pixels"});
  cases.push_back({{}, "--pixel is required (see kiloband trace --help)"});
  expect_refused(folder, trace({}), cases);
}

TEST(Device, ChosenByNumberOrName) {
  const TemporaryFolder folder;
  const std::string list = run_program(folder, {"devices"}).out;  // "index  name ...", then "    0  NAME ..."
  const std::size_t name = list.find("\n    0  ") + 8;
  for (const std::string& device : {std::string("0"), list.substr(name, 12)}) {
    const Outcome outcome = run_program(folder, trace({"--pixel", "1,1", "--device", device}));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(" on opencl ("), std::string::npos) << outcome.out;
  }
  const Outcome unknown = run_program(folder, trace({"--pixel", "1,1", "--device", "nosuchdevice"}));
  EXPECT_EQ(unknown.code, 2);
  EXPECT_EQ(unknown.err.rfind("kiloband: no OpenCL device has 'nosuchdevice' in its name: there is 0 '", 0),
            0u)
      << unknown.err;
  const Outcome number = run_program(folder, trace({"--pixel", "1,1", "--device", "99"}));
  EXPECT_EQ(number.code, 2);
  EXPECT_EQ(number.err.rfind("kiloband: no OpenCL device 99: there is 0 '", 0), 0u) << number.err;
}

TEST(Device, MoreMemoryThanThereIs) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  const Outcome outcome = run_program(folder, {"render", "scene.xml", "--spp", "1", "--bands", "400:700:2",
                                               "--device-memory", "100000GiB", "-o", "a.exr"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find(" MiB, not 102400000 MiB: these are used\n"), std::string::npos) << outcome.err;
}

TEST(Device, LessMemoryThanTheSceneTakes) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  const Outcome outcome =
      run_program(folder, quiet_render("scene.xml", {"--spp", "1", "--device-memory", "2kB", "-o", "a.exr"}));
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("of a budget of 2000 bytes in use)"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.list(), Names{"scene.xml"});
}

}  // namespace
}  // namespace kiloband::test
