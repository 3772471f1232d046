// Wrong command lines of `render`: one line says what is wrong.
#include <gtest/gtest.h>

#include "tests/end_to_end/support/wrong_input.hpp"

namespace kiloband::test {
namespace {

void write_inputs(const TemporaryFolder& folder) {
  folder.write("scene.xml", scene_text(R"xml(<default name="grey" value="0.5"/>
<bsdf type="diffuse" id="leaf"><float name="reflectance" value="$grey"/></bsdf>
)xml" + kSensor + kLight + kSphere));
  folder.write("glass.csv", "wavelength_nm,n\n400,1.5\n700,1.45\n");
  folder.write("glass.xml", scene_text(R"xml(<shape type="sphere">
<bsdf type="dielectric" id="lens"><string name="int_material" value="glass.csv"/></bsdf></shape>
)xml" + kSensor + kLight));
  folder.write("empty.spd", "# nothing\n");
  folder.write("zigzag.spd", "400 0.1\n500 0.2\n450 0.1\n");
  folder.write("reversed.csv", "min_nm,max_nm\n400,450\n500,450\n");
  folder.write("three.csv", "400,450,1\n");
  folder.write("word.csv", "wavelength_nm,red\n400,high\n");
  folder.write("twice.csv", "wavelength_nm,red,red\n400,1,1\n700,1,1\n");
  folder.write("a.csv", "wavelength_nm,red\n400,1\n700,1\n");
  folder.write("cube.hdr", "ENVI\n");
  folder.write("cube.exr", "\x76\x2f\x31\x01");  // what an EXR file begins with
}

TEST(WrongOption, Command) {
  const TemporaryFolder folder;
  write_inputs(folder);
  expect_refused(
      folder,
      std::vector<WrongCommand>{
          {"no command", {}, "A subcommand is required (see kiloband --help)"},
          {"unknown command",
           {"rendr", "scene.xml"},
           "unknown command 'rendr': must be render, info, convert, sensor, compare, sky, devices, trace or "
           "validate (see kiloband --help)"},
          {"scene missing", {"render"}, "SCENE is required (see kiloband render --help)"},
          {"scene not there", {"render", "none.xml"}, "none.xml: error: file not found"},
          {"scene is a folder", {"render", "."}, ".: error: not a regular file"},
          {"scene is a cube",
           {"info", "cube.exr"},
           "cube.exr: is a cube or an image, not a scene: must be a Mitsuba 3 scene file (XML); kiloband "
           "convert reads cubes"},
          {"cube is rendered",
           {"render", "cube.exr"},
           "cube.exr: is a cube or an image, not a scene: must be a Mitsuba 3 scene file (XML); kiloband "
           "convert reads cubes"},
          {"scene is an ENVI header",
           {"info", "cube.hdr"},
           "cube.hdr: is a cube or an image, not a scene: must be a Mitsuba 3 scene file (XML); kiloband "
           "convert reads cubes"},
          {"cube not there", {"info", "none.exr"}, "none.exr: error: file not found"},
          {"unknown option", quiet_render("scene.xml", {"--spectral"}),
           "The following argument was not expected: --spectral (see kiloband render --help)"},
          {"misspelt option", quiet_render("scene.xml", {"--respone=4"}),
           "The following argument was not expected: --respone=4; did you mean '--response'? (see "
           "kiloband render --help)"},
          {"option with one dash", quiet_render("scene.xml", {"-spp"}),
           "The following argument was not expected: -spp; did you mean '--spp'? (see kiloband render "
           "--help)"},
          {"misspelt option of convert",
           {"convert", "cube.exr", "out.hdr", "--rebind"},
           "The following argument was not expected: --rebind; did you mean '--rebin'? (see kiloband "
           "convert --help)"},
          {"second scene", quiet_render("scene.xml", {"other.xml"}),
           "The following argument was not expected: other.xml (see kiloband render --help)"},
      });
}

TEST(WrongOption, ChannelsSizeAndStopping) {
  const TemporaryFolder folder;
  write_inputs(folder);
  expect_refused(
      folder,
      std::vector<WrongCommand>{
          {"bands ''", quiet_render("scene.xml", {"--bands", ""}), "--bands '': no channels"},
          {"bands '400'", quiet_render("scene.xml", {"--bands", "400"}),
           "--bands '400': '400': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
          {"bands '700:400:10'", quiet_render("scene.xml", {"--bands", "700:400:10"}),
           "--bands '700:400:10': the interval is reversed: 700 nm is above 400 nm"},
          {"bands '400:700:0'", quiet_render("scene.xml", {"--bands", "400:700:0"}),
           "--bands '400:700:0': count '0': must be a whole number from 1"},
          {"bands '400:700:2.5'", quiet_render("scene.xml", {"--bands", "400:700:2.5"}),
           "--bands '400:700:2.5': count '2.5': must be a whole number from 1"},
          {"bands '400:700:99999999'", quiet_render("scene.xml", {"--bands", "400:700:99999999"}),
           "--bands '400:700:99999999': 99999999 channels: at most 1048576"},
          {"bands 'nan:700:3'", quiet_render("scene.xml", {"--bands", "nan:700:3"}),
           "--bands 'nan:700:3': wavelength nan nm: must be finite and positive"},
          {"bands '0:700:3'", quiet_render("scene.xml", {"--bands", "0:700:3"}),
           "--bands '0:700:3': wavelength 0 nm: must be finite and positive"},
          {"bands '400:400:1'", quiet_render("scene.xml", {"--bands", "400:400:1"}),
           "--bands '400:400:1': the interval is empty"},
          {"bands 'a-b'", quiet_render("scene.xml", {"--bands", "a-b"}),
           "--bands 'a-b': 'a' is not a number"},
          {"bands '500-400'", quiet_render("scene.xml", {"--bands", "500-400"}),
           "--bands '500-400': '500-400': the interval is reversed: 500 nm is above 400 nm"},
          {"bands '400-500,'", quiet_render("scene.xml", {"--bands", "400-500,"}),
           "--bands '400-500,': an interval is missing"},
          {"bands '400-500,550'", quiet_render("scene.xml", {"--bands", "400-500,550"}),
           "--bands '400-500,550': '550': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
          {"band file missing", quiet_render("scene.xml", {"--bands-file", "none.csv"}),
           "none.csv: cannot be opened: no such file"},
          {"band file without channels", quiet_render("scene.xml", {"--bands-file", "empty.spd"}),
           "empty.spd: no channels"},
          {"band file reversed", quiet_render("scene.xml", {"--bands-file", "reversed.csv"}),
           "reversed.csv:3: the interval is reversed: 500 nm is above 450 nm"},
          {"band file with three columns", quiet_render("scene.xml", {"--bands-file", "three.csv"}),
           "three.csv:1: must be MIN,MAX"},
          {"bands given in two ways",
           quiet_render("scene.xml", {"--bands", "400:700:3", "--bands-file", "reversed.csv"}),
           "--bands excludes --bands-file (see kiloband render --help)"},
          {"guide bands", quiet_render("scene.xml", {"--guide-bands", "blue"}),
           "--guide-bands 'blue': 'blue': must be FIRST:LAST:COUNT or MIN-MAX, MIN-MAX, ..."},
          {"size '10'", quiet_render("scene.xml", {"--size", "10"}),
           "--size 10: must be WIDTHxHEIGHT, for example 640x480"},
          {"size '10x'", quiet_render("scene.xml", {"--size", "10x"}),
           "--size 10x: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {"size '0x3'", quiet_render("scene.xml", {"--size", "0x3"}),
           "--size 0x3: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {"size '-3x3'", quiet_render("scene.xml", {"--size", "-3x3"}),
           "--size -3x3: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {"size '100000x3'", quiet_render("scene.xml", {"--size", "100000x3"}),
           "--size 100000x3: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {"size '4294967297x1'", quiet_render("scene.xml", {"--size", "4294967297x1"}),
           "--size 4294967297x1: must be WIDTHxHEIGHT with both from 1 to 65535"},
          {"size ''", quiet_render("scene.xml", {"--size", ""}),
           "--size : must be WIDTHxHEIGHT, for example 640x480"},
          {"time 'abc'", quiet_render("scene.xml", {"--time", "abc"}),
           "--time abc: must be a positive time such as 60s, 5min or 2h"},
          {"time '-3s'", quiet_render("scene.xml", {"--time", "-3s"}),
           "--time -3s: must be a positive time such as 60s, 5min or 2h"},
          {"time 'nan'", quiet_render("scene.xml", {"--time", "nan"}),
           "--time nan: must be a positive time such as 60s, 5min or 2h"},
          {"time '5 parsecs'", quiet_render("scene.xml", {"--time", "5 parsecs"}),
           "--time 5 parsecs: must be a positive time such as 60s, 5min or 2h"},
          {"time ''", quiet_render("scene.xml", {"--time", ""}),
           "--time : must be a positive time such as 60s, 5min or 2h"},
          {"target error '0'", quiet_render("scene.xml", {"--target-error", "0"}),
           "--target-error 0: must be positive, such as 1% or 0.01"},
          {"target error '-1%'", quiet_render("scene.xml", {"--target-error", "-1%"}),
           "--target-error -1%: must be positive, such as 1% or 0.01"},
          {"target error 'inf'", quiet_render("scene.xml", {"--target-error", "inf"}),
           "--target-error inf: must be positive, such as 1% or 0.01"},
          {"target error '5x'", quiet_render("scene.xml", {"--target-error", "5x"}),
           "--target-error 5x: must be positive, such as 1% or 0.01"},
          {"target error '1'", quiet_render("scene.xml", {"--target-error", "1"}),
           "--target-error 1: must have a % from 1 on, such as 1%; without it, be below 1"},
          {"target error '5'", quiet_render("scene.xml", {"--target-error", "5"}),
           "--target-error 5: must have a % from 1 on, such as 1%; without it, be below 1"},
          {"target error ''", quiet_render("scene.xml", {"--target-error", ""}),
           "--target-error : must be positive, such as 1% or 0.01"},
          {"too few samples for an error", quiet_render("scene.xml", {"--spp", "3", "--target-error", "1%"}),
           "--target-error needs error bars: --spp 3 makes 1 replicate, at least 4 are needed"},
          {"error without replicates",
           quiet_render("scene.xml", {"--target-error", "1%", "--replicates", "1"}),
           "--target-error needs error bars, --replicates 1 gives none: must be at least 2"},
          {"variance without replicates", quiet_render("scene.xml", {"--variance", "--replicates", "1"}),
           "--variance needs error bars, --replicates 1 gives none: must be at least 2"},
          {"definition without value", quiet_render("scene.xml", {"-D", "res"}),
           "-D res: must be name=value"},
          {"definition without name", quiet_render("scene.xml", {"-D", "=3"}), "-D =3: must be name=value"},
          {"definition of nothing", quiet_render("scene.xml", {"-D", "size=3"}),
           "scene.xml: error: -D size=3: the scene has no parameter '$size'"},
          {"definition with a wrong value", quiet_render("scene.xml", {"-D", "grey=2"}),
           "scene.xml:3:65: error: bsdf 'leaf': reflectance 2: must be in [0, 1]"},
          {"definition given twice", quiet_render("scene.xml", {"-D", "grey=0.1", "-D", "grey=0.2"}),
           "-D grey=0.2: the parameter is given twice"},
      });
}

TEST(WrongOption, SamplingAndOutput) {
  const TemporaryFolder folder;
  write_inputs(folder);
  expect_refused(
      folder,
      std::vector<WrongCommand>{
          {"--spp 0", quiet_render("scene.xml", {"--spp", "0"}),
           "--spp: Value 0 not in range 1 to 4294967295 (see kiloband render --help)"},
          {"--spp -1", quiet_render("scene.xml", {"--spp", "-1"}),
           "--spp: Value -1 not in range 1 to 4294967295 (see kiloband render --help)"},
          {"--spp 1.5", quiet_render("scene.xml", {"--spp", "1.5"}),
           "--spp: Value 1.5 not in range 1 to 4294967295 (see kiloband render --help)"},
          {"--seed -1", quiet_render("scene.xml", {"--seed", "-1"}),
           "--seed: Value -1 not a whole number from 0 to 18446744073709551615 (see kiloband render --help)"},
          {"--seed 1e3", quiet_render("scene.xml", {"--seed", "1e3"}),
           "--seed: Value 1e3 not a whole number from 0 to 18446744073709551615 (see kiloband render "
           "--help)"},
          {"--seed 99999999999999999999", quiet_render("scene.xml", {"--seed", "99999999999999999999"}),
           "--seed: Value 99999999999999999999 not a whole number from 0 to 18446744073709551615 (see "
           "kiloband render --help)"},
          {"--threads -1", quiet_render("scene.xml", {"--threads", "-1"}),
           "--threads: Value -1 not in range 0 to 4096 (see kiloband render --help)"},
          {"--isa mmx", quiet_render("scene.xml", {"--isa", "mmx"}),
           "--isa: mmx not in {auto,sse4,avx2,avx512} (see kiloband render --help)"},
          {"--backend vulkan", quiet_render("scene.xml", {"--backend", "vulkan"}),
           "--backend: vulkan not in {auto,cpu,opencl} (see kiloband render --help)"},
          {"--sampler halton", quiet_render("scene.xml", {"--sampler", "halton"}),
           "--sampler: halton not in {sobol,independent} (see kiloband render --help)"},
          {"--wavelengths hero", quiet_render("scene.xml", {"--wavelengths", "hero"}),
           "--wavelengths: hero not in {shared,per-path} (see kiloband render --help)"},
          {"--replicates 0", quiet_render("scene.xml", {"--replicates", "0"}),
           "--replicates: Value 0 not in range 1 to 4096 (see kiloband render --help)"},
          {"--max-depth -2", quiet_render("scene.xml", {"--max-depth", "-2"}),
           "--max-depth: Value -2 not in range -1 to 1073741824 (see kiloband render --help)"},
          {"--aov colour", quiet_render("scene.xml", {"--aov", "colour"}),
           "--aov: colour not in {depth,normal,object,material} (see kiloband render --help)"},
          {"--aov depth,depth", quiet_render("scene.xml", {"--aov", "depth,depth"}),
           "scene.exr: auxiliary plane 'depth': given twice"},
          {"--quantity flux", quiet_render("scene.xml", {"--quantity", "flux"}),
           "--quantity: flux not in {integral,density} (see kiloband render --help)"},
          {"-o out.jpg", quiet_render("scene.xml", {"-o", "out.jpg"}),
           "'out.jpg': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {"output before the scene", quiet_render("none.xml", {"-o", "out.jpg"}),
           "'out.jpg': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {"preview before the scene", quiet_render("none.xml", {"--preview", "out.jpg"}),
           "--preview out.jpg: must end in .png"},
          {"-o ", quiet_render("scene.xml", {"-o", ""}),
           "'': cannot tell the format of a cube: must end in .exr or .hdr (ENVI)"},
          {"--preview out.jpg", quiet_render("scene.xml", {"--preview", "out.jpg"}),
           "--preview out.jpg: must end in .png"},
          {"--preview ", quiet_render("scene.xml", {"--preview", ""}), "--preview : must end in .png"},
          {"--response none.csv", quiet_render("scene.xml", {"--response", "none.csv"}),
           "none.csv: cannot be opened: no such file"},
          {"--response empty.spd", quiet_render("scene.xml", {"--response", "empty.spd"}),
           "empty.spd: no data"},
          {"--response word.csv", quiet_render("scene.xml", {"--response", "word.csv"}),
           "word.csv:2: 'high' is not a number"},
          {"--response twice.csv", quiet_render("scene.xml", {"--response", "twice.csv"}),
           "twice.csv: column name 'red' is repeated"},
          {"output given twice", quiet_render("scene.xml", {"-o", "out.exr", "-o", "./out.exr"}),
           "-o ./out.exr: another output has this name"},
          {"preview over an output", quiet_render("scene.xml", {"-o", "out.png", "--preview", "out.png"}),
           "--preview out.png: another output has this name"},
          {"statistics over ENVI data", quiet_render("scene.xml", {"-o", "out.hdr", "--stats", "out.img"}),
           "--stats out.img: another output has this name"},
          {"over variances", quiet_render("scene.xml", {"-o", "out.hdr", "-o", "out.var.hdr", "--variance"}),
           "-o out.var.hdr: another output has this name"},
          {"over a replicate",
           quiet_render("scene.xml", {"-o", "out.exr", "-o", "out.r03.exr", "--keep-replicates"}),
           "-o out.r03.exr: another output has this name"},
          {"checkpoint over the scene", quiet_render("scene.xml", {"--checkpoint", "scene.xml"}),
           "--checkpoint scene.xml: would replace the scene"},
          {"checkpoint over data", quiet_render("scene.xml", {"-o", "out.hdr", "--checkpoint", "out.img"}),
           "--checkpoint out.img: another output has this name"},
          {"statistics over the scene", quiet_render("scene.xml", {"--stats", "scene.xml"}),
           "--stats scene.xml: would replace the scene"},
          {"response given twice", quiet_render("scene.xml", {"--response", "a.csv", "--response", "a.csv"}),
           "response 'red' is given twice"},
          {"ambiguous response wavelengths", quiet_render("scene.xml", {"--response", "zigzag.spd"}),
           "zigzag.spd:3: wavelength 450 nm after 500 nm: the order changes"},
          {"missing index in a channel",
           {"render", "glass.xml", "--quiet", "--bands", "400:1000:3"},
           "glass.xml:3:2: error: bsdf 'lens': int_ior: data from 400 to 700 nm do not cover channel 600-800 "
           "nm"},
      });
}

TEST(WrongOption, Backends) {
  const TemporaryFolder folder;
  write_inputs(folder);
  std::vector<WrongCommand> cases{
      {"--method bdpt", quiet_render("scene.xml", {"--method", "bdpt"}),
       "--method: bdpt not in {dpept-batch,dpept-path,pt} (see kiloband render --help)"},
      {"--method on the CPU", quiet_render("scene.xml", {"--backend", "cpu", "--method", "pt"}),
       "--method does not apply to --backend cpu"},
      {"--device on the CPU", quiet_render("scene.xml", {"--backend", "cpu", "--device", "0"}),
       "--device does not apply to --backend cpu"},
      {"--device-memory on the CPU",
       quiet_render("scene.xml", {"--backend", "cpu", "--device-memory", "1GiB"}),
       "--device-memory does not apply to --backend cpu"},
      {"--isa on a device", quiet_render("scene.xml", {"--backend", "opencl", "--isa", "avx2"}),
       "--isa does not apply to --backend opencl"},
      {"--threads on a device", quiet_render("scene.xml", {"--backend", "opencl", "--threads", "2"}),
       "--threads does not apply to --backend opencl"},
      {"options of both", quiet_render("scene.xml", {"--threads", "2", "--method", "pt"}),
       "--threads is for the CPU backend, --method for the OpenCL one: choose with --backend"},
      {"trace has no methods",
       {"trace", "scene.xml", "--pixel", "0,0", "--method", "pt"},
       "The following arguments were not expected: pt --method (see kiloband trace --help)"},
  };
  cases.push_back({"--device-memory", quiet_render("scene.xml", {"--device-memory="}),
                   "--device-memory: 1 required TEXT missing (see kiloband render --help)"});
  for (const std::string amount :
       {"four", "0", "-1GiB", "4XiB", "4 gib", "nan", "inf", "1e30", "GiB", "0.1"}) {
    cases.push_back(
        {"--device-memory " + amount, quiet_render("scene.xml", {"--device-memory=" + amount}),
         "--device-memory " + amount + ": must be an amount of memory such as 4GiB, 512MiB or 2e9"});
  }
  expect_refused(folder, cases);
}

}  // namespace
}  // namespace kiloband::test
