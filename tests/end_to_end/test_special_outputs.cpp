// Outputs that are links, pipes and devices: written to, never replaced.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <map>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/special_files.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;

/// A named pipe that is open at both ends here, so that neither side waits; it holds 64 KiB.
class OpenPipe {
 public:
  explicit OpenPipe(const std::filesystem::path& file) : file_(file) {
    make_pipe(file);
    descriptor_ = open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  }
  ~OpenPipe() { close(descriptor_); }
  OpenPipe(const OpenPipe&) = delete;

  /// What has come so far.
  std::string read_all() const {
    std::string text(65536, '\0');
    const ssize_t size = read(descriptor_, text.data(), text.size());
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
  }
  bool stands() const { return std::filesystem::is_fifo(file_); }

 private:
  std::filesystem::path file_;
  int descriptor_;
};

/// 8 x 8 pixels in 3 channels with replicates: box.hdr and what it takes.
void render_box(const TemporaryFolder& folder) {
  const Outcome outcome = run_program(
      folder,
      quiet_render(cornell_box(), {"--size", "8x8", "--bands", "400:700:3", "--spp", "8", "--replicates", "2",
                                   "--keep-replicates", "--variance", "-o", "box.hdr"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
}

struct Command {
  Names arguments;  // that write "out.TYPE"
  std::string name, begins;
};

std::vector<Command> commands() {
  const Names render = quiet_render(cornell_box(), {"--size", "8x8", "--bands", "400:700:3", "--spp", "1"});
  const auto with = [](Names arguments, const Names& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  return {
      {with(render, {"-o", "x.exr", "--stats", "out.json"}), "out.json", "{"},
      {with(render, {"-o", "x.exr", "--preview", "out.png"}), "out.png", "\x89PNG"},
      {with(render, {"-o", "out.exr"}), "out.exr", "\x76\x2f\x31\x01"},
      {with(render, {"-o", "out.hdr"}), "out.hdr", "ENVI"},
      {{"convert", "box.hdr", "out.csv", "--pixel", "1,1"}, "out.csv", "channel,"},
      {{"convert", "box.hdr", "out.exr"}, "out.exr", "\x76\x2f\x31\x01"},
      {{"sensor", "box.hdr", "--response", "xyz", "-o", "out.csv", "--pixel", "1,1"}, "out.csv", "channel,"},
      {{"sensor", "box.hdr", "--png", "out.png"}, "out.png", "\x89PNG"},
      {{"compare", "box.hdr", "box.hdr", "--paired", "--json", "out.json"}, "out.json", "{"},
      {{"sky", "out.exr", "--size", "8x5", "--bands", "400:700:3"}, "out.exr", "\x76\x2f\x31\x01"},
      {{"sky", "x.exr", "--size", "8x5", "--bands", "400:700:3", "--preview", "out.png"},
       "out.png",
       "\x89PNG"}};
}

TEST(SpecialOutputs, EveryCommandWritesToPipes) {
  const TemporaryFolder folder;
  render_box(folder);
  for (const Command& command : commands()) {
    const OpenPipe pipe(folder / command.name);
    const Outcome outcome = run_program(folder, command.arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(pipe.read_all().substr(0, command.begins.size()), command.begins) << command.arguments.front();
    EXPECT_TRUE(pipe.stands()) << command.arguments.front();
    for (const char* end : {".exr", ".hdr", ".img", ".json", ".csv", ".png"}) {
      std::filesystem::remove(folder / (std::string("out") + end));
      std::filesystem::remove(folder / (std::string("x") + end));
    }
  }
}

TEST(SpecialOutputs, AFullDeviceIsAnErrorOfEveryCommand) {
  const TemporaryFolder folder;
  render_box(folder);
  for (const Command& command : commands()) {
    make_full_device(folder / command.name);
    const Outcome outcome = run_program(folder, command.arguments);
    EXPECT_EQ(outcome.code, 3) << command.arguments.front();
    expect_text(outcome.err, "kiloband: cannot write '" + command.name + "': No space left on device\n");
    EXPECT_TRUE(std::filesystem::is_character_file(folder / command.name)) << command.arguments.front();
    std::filesystem::remove(folder / command.name);
    for (const char* rest : {"x.exr", "out.img"}) std::filesystem::remove(folder / rest);
  }
}

TEST(SpecialOutputs, StandardOutputByItsName) {
  const TemporaryFolder folder;
  render_box(folder);
  const Names arguments{"compare", "box.hdr", "box.hdr", "--paired", "--json"};
  const auto json_to = [&](const std::string& file) {
    Names all = arguments;
    all.push_back(file);
    const Outcome outcome = run_program(folder, all);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out;
  };
  const std::string text = json_to("a.json");
  EXPECT_EQ(json_to("/dev/stdout"), folder.read("a.json") + text);
  EXPECT_EQ(json_to("/dev/fd/1"), folder.read("a.json") + text);
}

TEST(SpecialOutputs, OneFileByTwoNamesIsRefused) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  folder.write("old.json", "old");
  std::filesystem::create_symlink("out.img", folder / "link.json");
  std::filesystem::create_symlink("scene.xml", folder / "scene.json");
  std::filesystem::create_hard_link(folder / "old.json", folder / "same.png");
  std::filesystem::create_directory_symlink(".", folder / "here");
  const Names before = folder.list();
  const auto refused = [&](const Names& arguments, const std::string& message) {
    const Outcome outcome = run_program(folder, arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_EQ(outcome.err, "kiloband: " + message + "\n");
    EXPECT_EQ(folder.list(), before);
  };
  const auto render = [&](const Names& outputs) { return quiet_render("scene.xml", outputs); };
  refused(render({"-o", "out.hdr", "--stats", "link.json"}),
          "--stats link.json: a link makes this the same file as the output out.img");
  refused(render({"-o", "a.exr", "-o", "here/a.exr"}),
          "-o here/a.exr: a link makes this the same file as the output a.exr");
  refused(render({"-o", "a.exr", "--preview", "same.png", "--stats", "old.json"}),
          "--stats old.json: a link makes this the same file as the output same.png");
  refused(render({"-o", "a.exr", "--stats", "scene.json"}), "--stats scene.json: would replace the scene");
}

TEST(SpecialOutputs, SensorAndCompareCheckTheirOutputs) {
  const TemporaryFolder folder;
  render_box(folder);
  const auto refused = [&](const Names& arguments, const std::string& message) {
    const Outcome outcome = run_program(folder, arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_EQ(outcome.err, "kiloband: " + message + "\n");
  };
  refused({"sensor", "box.hdr", "--response", "xyz", "-o", "a.exr", "-o", "./a.exr"},
          "-o ./a.exr: another output has this name");
  refused({"compare", "box.hdr", "box.hdr", "--paired", "--json", "box.hdr"},
          "--json box.hdr: would replace A");
  refused({"sensor", "box.hdr", "--response", "xyz", "-o", "box.hdr"}, "-o box.hdr: would replace the cube");
}

/// Bands, responses, masks and backgrounds were overwritten by outputs of the same name.
TEST(SpecialOutputs, WhatIsReadStays) {
  const TemporaryFolder folder;
  render_box(folder);
  folder.write("r.csv", "wavelength_nm,r\n400,1\n700,1\n");
  folder.write("bands.csv", "400,500\n500,600\n");
  folder.write("field.xml", complete_scene(""));
  const Names region{"--signature", "--region", "0,0,2,2"};
  const auto refused = [&](Names arguments, const Names& more, const std::string& message) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_program(folder, arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_EQ(outcome.err, "kiloband: " + message + "\n");
  };
  refused({"sensor", "box.hdr", "--response", "r.csv", "-o", "r.csv"}, region,
          "-o r.csv: would replace the file of --response");
  refused(
      {"sensor", "box.hdr", "--response", "r.csv", "-o", "t.csv", "--background", "b.hdr", "--mask", "t.csv"},
      region, "-o t.csv: would replace the file of --mask");
  refused({"convert", "box.hdr", "b.csv", "--background", "b.csv"}, region,
          "OUT b.csv: would replace the file of --background");
  refused({"convert", "box.hdr", "box.hdr", "--select", "0"}, {}, "-o box.hdr: would replace the cube");
  refused({"render", "field.xml", "--bands-file", "bands.csv", "--stats", "bands.csv"}, {},
          "--stats bands.csv: would replace the file of --bands-file");
  refused({"render", "field.xml", "--response", "r.csv", "--stats", "r.csv"}, {},
          "--stats r.csv: would replace the file of --response");
  refused({"sky", "a.exr", "--bands-file", "bands.csv", "--preview", "bands.csv"}, {},
          "--preview bands.csv: would replace the file of --bands-file");
  refused({"sky", "a.exr", "--sun", "field.xml"}, {},
          "--sun field.xml: would replace a file that kiloband sky has not written: remove it, or choose "
          "another name");
}

std::map<std::string, std::string> contents(const TemporaryFolder& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : folder.list()) files[name] = folder.read(name);
  return files;
}

/// Nothing is rendered over what the scene reads, by the name that nobody has given least of all.
TEST(SpecialOutputs, WhatTheSceneReadsStays) {
  const TemporaryFolder folder;
  for (const char* map : {"dawn.exr", "dusk.hdr", "wood.exr"})
    ASSERT_EQ(
        run_program(folder, {"sky", map, "--size", "8x5", "--bands", "400:700:3", "--preview", "wood.png"})
            .code,
        0);
  folder.write("grey.spd", "400 0.5\n700 0.5\n");
  const auto sky = [](const char* file) {
    return std::string("<emitter type=\"spectral_envmap\"><string name=\"filename\" value=\"") + file +
           "\"/></emitter>";
  };
  const auto ball = [](const std::string& reflectance) {
    return "<shape type=\"sphere\"><bsdf type=\"diffuse\">" + reflectance + "</bsdf></shape>";
  };
  folder.write("dawn.xml", scene_text(kSensor + kSphere + sky("dawn.exr")));
  folder.write("dusk.xml", scene_text(kSensor + kSphere + sky("dusk.hdr")));
  folder.write("part.xml", scene_text(ball(R"(<spectrum name="reflectance" filename="grey.spd"/>)")));
  folder.write(
      "ball.xml",
      scene_text(
          kSensor + sky("dawn.exr") + R"(<include filename="part.xml"/>)" +
          ball(
              R"(<texture type="bitmap" name="reflectance"><string name="filename" value="wood.png"/></texture>)")));
  const auto before = contents(folder);
  const auto refused = [&](const char* scene, const Names& outputs, const std::string& message) {
    const Outcome outcome = run_program(folder, quiet_render(scene, outputs));
    EXPECT_EQ(outcome.code, 2) << message;
    EXPECT_EQ(outcome.err, "kiloband: " + message + ": would replace a file of the scene\n");
    EXPECT_EQ(contents(folder), before);
  };
  refused("dawn.xml", {}, "-o dawn.exr");
  refused("dusk.xml", {"-o", "./dusk.hdr"}, "-o ./dusk.hdr");
  refused("dusk.xml", {"-o", "a.exr", "--stats", "dusk.img"}, "--stats dusk.img");
  refused("ball.xml", {"--preview", "wood.png"}, "--preview wood.png");
  refused("ball.xml", {"--stats", "grey.spd"}, "--stats grey.spd");
  refused("ball.xml", {"--stats", "part.xml"}, "--stats part.xml");
}

/// A cube is more than the file that names it.
TEST(SpecialOutputs, AllFilesOfACubeThatIsReadStay) {
  const TemporaryFolder folder;
  render_box(folder);
  folder.write("x.img", std::string(8, '\1'));
  folder.write("x.img.hdr",
               "ENVI\nsamples = 2\nlines = 1\nbands = 2\ndata type = 2\ninterleave = bsq\nbyte order = 0\n"
               "wavelength units = nm\nwavelength = {500, 600}\nfwhm = {10, 10}\n");
  const auto before = contents(folder);
  const auto refused = [&](const Names& arguments, const std::string& message) {
    const Outcome outcome = run_program(folder, arguments);
    EXPECT_EQ(outcome.code, 2) << message;
    expect_text(outcome.err, "kiloband: " + message + "\n");
    EXPECT_EQ(contents(folder), before);
  };
  refused({"convert", "x.img.hdr", "x.hdr", "--select", "0-1"}, "-o x.img: would replace the cube");
  refused({"sensor", "x.img.hdr", "--response", "xyz", "-o", "x.hdr"}, "-o x.img: would replace the cube");
  refused({"convert", "box.hdr", "box.HDR", "--select", "0-1"}, "-o box.img: would replace the cube");
  refused({"convert", "box.img", "box.hdr", "--select", "0-1"}, "-o box.hdr: would replace the cube");
  refused({"sensor", "box.hdr", "--response", "xyz", "-o", "box.r00.hdr"},
          "-o box.r00.hdr: would replace the cube");
  refused({"compare", "box.hdr", "box.hdr", "--paired", "--json", "box.img"},
          "--json box.img: would replace A");
  refused({"compare", "box.hdr", "x.img.hdr", "--json", "box.var.img"},
          "--json box.var.img: would replace A");
  refused({"compare", "box.r00.hdr", "x.img.hdr", "--variance-a", "box.var.hdr", "--json", "box.var.img"},
          "--json box.var.img: would replace A's variances");
}

}  // namespace
}  // namespace kiloband::test
