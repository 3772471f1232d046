// Wrong command lines of `render`: one line says what is wrong.
#include <gtest/gtest.h>

#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test::test_options {
namespace {

void write_inputs(const TemporaryFolder& folder) {
  folder.write("scene.xml", scene_text(R"xml(<default name="grey" value="0.5"/>
<bsdf type="diffuse" id="leaf"><float name="reflectance" value="$grey"/></bsdf>
)xml" + kSensor + kLight + kSphere));
  folder.write("glass.csv", "wavelength_nm,n\n400,1.5\n700,1.45\n");
  folder.write("glass.xml", scene_text(R"xml(<shape type="sphere">
<bsdf type="dielectric" id="lens"><string name="int_material" value="glass.csv"/></bsdf></shape>
)xml" + kSensor + kLight));
  folder.write("reversed.csv", "min_nm,max_nm\n400,450\n500,450\n");
  folder.write("a.csv", "wavelength_nm,red\n400,1\n700,1\n");
  folder.write("cube.hdr", "ENVI\n");
  folder.write("cube.exr", "\x76\x2f\x31\x01");  // what an EXR file begins with
}

TEST(WrongOption, Command) {
  const TemporaryFolder folder;
  write_inputs(folder);
  expect_refused(
      folder, {},
      {
          {{}, "A subcommand is required (see kiloband --help)"},
          {{"rendr", "scene.xml"},
           "unknown command 'rendr': must be render, info, convert, sensor, compare, sky, devices, tune, trace, "
           "validate, bench or view (see kiloband --help)"},
          {{"render"}, "SCENE is required (see kiloband render --help)"},
          {{"render", "none.xml"}, "none.xml: error: file not found"},
          {{"render", "."}, ".: error: not a regular file"},
          {{"info", "cube.exr"},
           "cube.exr: is a cube or an image, not a scene: must be a Mitsuba 3 scene file (XML); kiloband "
           "convert reads cubes"},
          {{"render", "cube.exr"},
           "cube.exr: is a cube or an image, not a scene: must be a Mitsuba 3 scene file (XML); kiloband "
           "convert reads cubes"},
          {{"info", "cube.hdr"},
           "cube.hdr: is a cube or an image, not a scene: must be a Mitsuba 3 scene file (XML); kiloband "
           "convert reads cubes"},
          {{"info", "none.exr"}, "none.exr: error: file not found"},
          {{"convert", "cube.exr", "out.hdr", "--rebind"},
           "The following argument was not expected: --rebind; did you mean '--rebin'? (see kiloband "
           "convert --help)"},
      });
  expect_refused(
      folder, {"render", "scene.xml", "--quiet"},
      {
          {{"--spectral"},
           "The following argument was not expected: --spectral (see kiloband render --help)"},
          {{"--respone=4"},
           "The following argument was not expected: --respone=4; did you mean '--response'? (see "
           "kiloband render --help)"},
          {{"-spp"},
           "The following argument was not expected: -spp; did you mean '--spp'? (see kiloband render "
           "--help)"},
          {{"other.xml"}, "The following argument was not expected: other.xml (see kiloband render --help)"},
      });
}

TEST(WrongOption, ChannelsSizeAndStopping) {
  const TemporaryFolder folder;
  write_inputs(folder);
  expect_refused(
      folder, {"render", "scene.xml", "--quiet"},
      {
          {{"--bands", ""}, "--bands '': no channels"},
          {{"--bands", "700:400:10"},
           "--bands '700:400:10': the interval is reversed: 700 nm is above 400 nm"},
          {{"--bands-file", "reversed.csv"},
           "reversed.csv:3: the interval is reversed: 500 nm is above 450 nm"},
          {{"--bands", "400:700:3", "--bands-file", "reversed.csv"},
           "--bands excludes --bands-file (see kiloband render --help)"},
          {{"--guide-bands", "blue"},
           "--guide-bands 'blue': 'blue': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
          {{"--size", "10"}, "--size 10: must be WIDTHxHEIGHT, for example 640x480"},
          {{"--size", "10x"}, "--size 10x: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {{"--size", "0x3"}, "--size 0x3: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {{"--size", "-3x3"}, "--size -3x3: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {{"--size", "100000x3"}, "--size 100000x3: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {{"--size", "4294967297x1"}, "--size 4294967297x1: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {{"--size", ""}, "--size : must be WIDTHxHEIGHT, for example 640x480"},
          {{"--time", "abc"}, "--time abc: must be a positive time such as 60s, 5min or 2h"},
          {{"--time", "-3s"}, "--time -3s: must be a positive time such as 60s, 5min or 2h"},
          {{"--time", "nan"}, "--time nan: must be a positive time such as 60s, 5min or 2h"},
          {{"--time", "5 parsecs"}, "--time 5 parsecs: must be a positive time such as 60s, 5min or 2h"},
          {{"--time", ""}, "--time : must be a positive time such as 60s, 5min or 2h"},
          {{"--target-error", "0"}, "--target-error 0: must be positive, such as 1% or 0.01"},
          {{"--target-error", "-1%"}, "--target-error -1%: must be positive, such as 1% or 0.01"},
          {{"--target-error", "inf"}, "--target-error inf: must be positive, such as 1% or 0.01"},
          {{"--target-error", "5x"}, "--target-error 5x: must be positive, such as 1% or 0.01"},
          {{"--target-error", "1"},
           "--target-error 1: must have a % from 1 on, such as 1%; without it, be below 1"},
          {{"--target-error", "5"},
           "--target-error 5: must have a % from 1 on, such as 1%; without it, be below 1"},
          {{"--target-error", ""}, "--target-error : must be positive, such as 1% or 0.01"},
          {{"--spp", "3", "--target-error", "1%"},
           "--target-error needs error bars: --spp 3 makes 1 replicate, at least 4 are needed"},
          {{"--target-error", "1%", "--replicates", "1"},
           "--target-error needs error bars, --replicates 1 gives none: must be at least 2"},
          {{"--variance", "--replicates", "1"},
           "--variance needs error bars, --replicates 1 gives none: must be at least 2"},
          {{"--keep-replicates", "--replicates", "1"},
           "--keep-replicates needs error bars, --replicates 1 gives none: must be at least 2"},
          {{"-D", "res"}, "-D res: must be name=value"},
          {{"-D", "=3"}, "-D =3: must be name=value"},
          {{"-D", "size=3"}, "scene.xml: error: -D size=3: the scene has no parameter '$size'"},
          {{"-D", "grey=2"}, "scene.xml:3:65: error: bsdf 'leaf': reflectance 2: must be in [0, 1]"},
          {{"-D", "grey=0.1", "-D", "grey=0.2"}, "-D grey=0.2: the parameter is given twice"},
      });
}

TEST(WrongOption, SeedsOfWholeRuns) {
  const TemporaryFolder folder;
  for (const std::string command : {"validate", "bench"}) {
    const std::string rule =
        " not a whole number from 0 to 18446744073709551615 (see kiloband " + command + " --help)";
    expect_refused(folder, {command, "--list"},
                   {{{"--seed", "-1"}, "--seed: Value -1" + rule},
                    {{"--seed", "0x10"}, "--seed: Value 0x10" + rule},
                    {{"--seed", "99999999999999999999"}, "--seed: Value 99999999999999999999" + rule}});
  }
}

TEST(WrongOption, SamplingAndOutput) {
  const TemporaryFolder folder;
  write_inputs(folder);
  expect_refused(
      folder, {"render", "scene.xml", "--quiet"},
      {
          {{"--spp", "0"}, "--spp: Value 0 not in range 1 to 4294967295 (see kiloband render --help)"},
          {{"--spp", "-1"}, "--spp: Value -1 not in range 1 to 4294967295 (see kiloband render --help)"},
          {{"--spp", "1.5"}, "--spp: Value 1.5 not in range 1 to 4294967295 (see kiloband render --help)"},
          {{"--spp", "0x10"}, "--spp: Value 0x10 not in range 1 to 4294967295 (see kiloband render --help)"},
          {{"--seed", "-1"},
           "--seed: Value -1 not a whole number from 0 to 18446744073709551615 (see kiloband render --help)"},
          {{"--seed", "1e3"},
           "--seed: Value 1e3 not a whole number from 0 to 18446744073709551615 (see kiloband render "
           "--help)"},
          {{"--seed", "99999999999999999999"},
           "--seed: Value 99999999999999999999 not a whole number from 0 to 18446744073709551615 (see "
           "kiloband render --help)"},
          {{"--threads", "-1"}, "--threads: Value -1 not in range 0 to 4096 (see kiloband render --help)"},
          {{"--isa", "mmx"}, "--isa: mmx not in {auto,sse4,avx2,avx512} (see kiloband render --help)"},
          {{"--backend", "vulkan"},
           "--backend: vulkan not in {auto,cpu,opencl,cpu+opencl} (see kiloband render --help)"},
          {{"--sampler", "halton"},
           "--sampler: halton not in {sobol,independent} (see kiloband render --help)"},
          {{"--wavelengths", "hero"},
           "--wavelengths: hero not in {shared,per-path} (see kiloband render --help)"},
          {{"--replicates", "0"},
           "--replicates: Value 0 not in range 1 to 4096 (see kiloband render --help)"},
          {{"--max-depth", "-2"},
           "--max-depth: Value -2 not in range -1 to 1073741824 (see kiloband render --help)"},
          {{"--aov", "colour"},
           "--aov: colour not in {depth,normal,object,material} (see kiloband render --help)"},
          {{"--aov", "depth,depth"}, "scene.exr: auxiliary plane 'depth': given twice"},
          {{"--quantity", "flux"}, "--quantity: flux not in {integral,density} (see kiloband render --help)"},
          {{"-o", "out.jpg"}, "'out.jpg': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {{"-o", ""}, "'': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {{"--preview", "out.jpg"}, "--preview out.jpg: must end in .png"},
          {{"--preview", ""}, "--preview : must end in .png"},
          {{"--response", "none.csv"}, "none.csv: cannot be opened: no such file"},
          {{"--response", "a.csv", "--response", "a.csv"}, "response 'red' is given twice"},
          {{"-o", "out.exr", "-o", "./out.exr"}, "-o ./out.exr: another output has this name"},
          {{"-o", "out.png", "--preview", "out.png"}, "--preview out.png: another output has this name"},
          {{"-o", "out.hdr", "--stats", "out.img"}, "--stats out.img: another output has this name"},
          {{"-o", "out.hdr", "-o", "out.var.hdr", "--variance"},
           "-o out.var.hdr: another output has this name"},
          {{"-o", "out.exr", "-o", "out.r03.exr", "--keep-replicates"},
           "-o out.r03.exr: another output has this name"},
          {{"--checkpoint", "scene.xml"}, "--checkpoint scene.xml: would replace the scene"},
          {{"-o", "out.hdr", "--checkpoint", "out.img"},
           "--checkpoint out.img: another output has this name"},
          {{"--stats", "scene.xml"}, "--stats scene.xml: would replace the scene"},
      });
  expect_refused(
      folder, {"render", "none.xml", "--quiet"},
      {
          {{"-o", "out.jpg"}, "'out.jpg': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {{"--preview", "out.jpg"}, "--preview out.jpg: must end in .png"},
      });
  expect_refused(
      folder, {},
      {
          {{"render", "glass.xml", "--quiet", "--bands", "400:1000:3"},
           "glass.xml:3:2: error: bsdf 'lens': int_ior: data from 400 to 700 nm do not cover channel 600-800 "
           "nm: --bands names others"},
      });
}

TEST(WrongOption, Backends) {
  const TemporaryFolder folder;
  write_inputs(folder);
  std::vector<WrongCommand> cases{
      {{"--method", "bdpt"},
       "--method: bdpt not in {dpept-batch,dpept-path,pt} (see kiloband render --help)"},
      {{"--backend", "cpu", "--method", "pt"}, "--method does not apply to --backend cpu"},
      {{"--backend", "cpu", "--device", "0"}, "--device does not apply to --backend cpu"},
      {{"--backend", "cpu", "--device-memory", "1GiB"}, "--device-memory does not apply to --backend cpu"},
      {{"--backend", "opencl", "--isa", "avx2"}, "--isa does not apply to --backend opencl"},
      {{"--backend", "opencl", "--threads", "2"}, "--threads does not apply to --backend opencl"},
      {{"--threads", "2", "--method", "pt"},
       "--threads is for the CPU backend, --method for the OpenCL one: choose with --backend"},
      {{"--device-memory="}, "--device-memory: 1 required TEXT missing (see kiloband render --help)"},
  };
  for (const std::string amount : {"four", "0", "-1GiB", "4XiB", "4 gib", "nan", "inf", "1e30", "GiB", "0.1"})
    cases.push_back(
        {{"--device-memory=" + amount},
         "--device-memory " + amount + ": must be an amount of memory such as 4GiB, 512MiB or 2e9"});
  expect_refused(folder, {"render", "scene.xml", "--quiet"}, cases);
  expect_refused(folder, {"trace", "scene.xml", "--pixel", "0,0"},
                 {{{"--method", "pt"},
                   "The following arguments were not expected: pt --method (see kiloband trace --help)"}});
}

}  // namespace
}  // namespace kiloband::test::test_options
