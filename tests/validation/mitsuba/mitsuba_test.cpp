// How the suite finds Mitsuba and compares its images, with shell scripts in the interpreter's place.
#include "validation/suite/mitsuba.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "cube/cube_io.hpp"
#include "tests/support/messages.hpp"
#include "validation/suite/results.hpp"

namespace kiloband::validation {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// An interpreter: $1 is the Python script, what follows its options.
std::string interpreter(const test::TemporaryFolder& folder, const std::string& name,
                        const std::string& body) {
  const fs::path file = folder.write(name, "#!/bin/sh\n" + body + "\n");
  fs::permissions(file, fs::perms::owner_all);
  return file.string();
}

/// Has Mitsuba 9.8.7; otherwise does `body`.
std::string with_mitsuba(const test::TemporaryFolder& folder, const std::string& body = "exit 2") {
  return interpreter(
      folder, "with",
      "case $2 in --probe) echo warning >&2; echo '{\"mitsuba\": \"9.8.7\"}';; *) " + body + ";; esac");
}

MitsubaDriver driver_of(const std::string& python, const std::vector<std::string>& names) {
  MitsubaDriver driver{python, {{"mitsuba", "9.8.7"}}, "render.py", {}};
  for (const std::string& name : names) driver.scenes.push_back({name, "/no/" + name, 16, 8, "what"});
  return driver;
}

TEST(FindMitsuba, TheFirstInterpreterThatHasIt) {
  const test::TemporaryFolder folder;
  const std::string without = interpreter(folder, "without", "echo '{}'; exit 1"),
                    garbled = interpreter(folder, "garbled", "echo 1.0"), with = with_mitsuba(folder);
  const fs::path root = KILOBAND_SOURCE_DIR;
  const auto driver = find_mitsuba({{"./no python", without, garbled, with}, root}, {}, Effort::kStandard);
  ASSERT_TRUE(driver);
  EXPECT_EQ(driver->interpreter, with);
  EXPECT_EQ(driver->versions, (json{{"mitsuba", "9.8.7"}}));
  EXPECT_TRUE(fs::is_regular_file(driver->script)) << driver->script;
  EXPECT_EQ(driver->scenes.size(), mitsuba_cases(root).size());
  EXPECT_FALSE(find_mitsuba({{"./no python", without}, root}, {}, Effort::kThorough));
}

TEST(FindMitsuba, OnlyWhereARunWantsIt) {
  EXPECT_TRUE(wants_mitsuba({}, Effort::kStandard));
  EXPECT_TRUE(wants_mitsuba({"hard/", "mits"}, Effort::kThorough));
  EXPECT_TRUE(wants_mitsuba({"mitsuba/box"}, Effort::kStandard));
  EXPECT_FALSE(wants_mitsuba({"cornell_box"}, Effort::kStandard));
  EXPECT_FALSE(wants_mitsuba({}, Effort::kQuick));
  const test::TemporaryFolder folder;
  EXPECT_FALSE(find_mitsuba({{with_mitsuba(folder)}, "."}, {"cornell_box"}, Effort::kStandard));
}

TEST(FindMitsuba, ANameThatAsksForItIsAnErrorWithoutIt) {
  const test::TemporaryFolder folder;
  const std::string without = interpreter(folder, "without", "exit 2");
  EXPECT_EQ(test::error_of([&] {
              find_mitsuba({{without, "./python"}, "."}, {"hard/", "mitsuba/box"}, Effort::kStandard);
            }),
            "mitsuba/box: Mitsuba 3 is not there (pip install mitsuba), looked for by " + without +
                " and ./python");
  EXPECT_EQ(test::error_of([&] {
              find_mitsuba({{with_mitsuba(folder)}, "."}, {"mitsuba/box"}, Effort::kQuick);
            }),
            "mitsuba/box: a quick run has no case against Mitsuba (leave out --quick)");
}

TEST(FindMitsuba, ItsScenesAreCasesOfTheRun) {
  SuiteSettings settings;
  settings.mitsuba = driver_of("python", {"box", "ball"});
  settings.folders.scenes = fs::path(KILOBAND_SOURCE_DIR) / "scenes";
  settings.names = {"mitsuba/"};
  EXPECT_EQ(planned_names(settings), (std::vector<std::string>{"mitsuba/box", "mitsuba/ball"}));
  settings.names = {"mitsuba/ba"};
  EXPECT_EQ(planned_names(settings), std::vector<std::string>{"mitsuba/ball"});
}

// Every scene of the folder is in the table, and the other way round.
TEST(MitsubaCases, AreTheScenesOfTheFolder) {
  const fs::path root = KILOBAND_SOURCE_DIR;
  std::set<fs::path> files;
  for (const auto& file : fs::directory_iterator(root / "validation/mitsuba/scenes"))
    if (file.path().extension() == ".xml") files.insert(fs::absolute(file.path()));
  files.insert(fs::absolute(root / "scenes/cornell_box/cornell_box.xml"));
  std::set<fs::path> listed;
  for (const MitsubaCase& c : mitsuba_cases(root)) {
    EXPECT_TRUE(listed.insert(c.file).second) << c.name;
    EXPECT_EQ(c.file.stem(), c.name);
  }
  EXPECT_EQ(listed, files);
}

TEST(Mitsuba, ComparesOneBackendOfEachKindUnlessThorough) {
  const std::vector<std::string> all{"cpu", "opencl:pt", "opencl:dpept-path"};
  EXPECT_EQ(mitsuba_backends(all, Effort::kStandard), (std::vector<std::string>{"cpu", "opencl:pt"}));
  EXPECT_EQ(mitsuba_backends(all, Effort::kThorough), all);
}

// ---- images ------------------------------------------------------------------------------------------------

const MitsubaCase kBox{"box", "/no/box.xml", 16, 8, "a box"};

/// 100 with a scatter of 1 % in every pixel of a replicate; `factor`: of all.
stats::ReplicateImage noise(uint32_t seed, float factor = 1) {
  const std::size_t channels = parse_channels(kMitsubaBands).size();
  stats::ReplicateImage image{kMitsubaSize, kMitsubaSize, channels, kMitsubaReplicates, {}, {}};
  std::mt19937 random(seed);
  std::normal_distribution<float> scatter(100, 1);
  image.means.resize(kMitsubaReplicates * image.pixels() * channels);
  for (float& mean : image.means) mean = factor * scatter(random);
  image.samples.assign(kMitsubaReplicates * image.pixels(), 8);
  return image;
}

/// As render_mitsuba.py writes it.
void write_cubes(const stats::ReplicateImage& image, const fs::path& stem,
                 Quantity quantity = Quantity::kIntegral, const std::string& bands = kMitsubaBands) {
  CubeInfo info;
  info.width = image.width;
  info.height = image.height;
  info.quantity = quantity;
  for (const Channel& channel : parse_channels(bands)) info.bands.push_back({channel, false});
  const std::size_t values = image.pixels() * image.channels;
  for (uint32_t r = 0; r < image.replicates; ++r) {
    const auto writer =
        create_cube_writer(fmt::format("{}.r{:02d}.hdr", stem.string(), r), info, image.height);
    writer->write_rows({0, image.height, std::span(image.means).subspan(r * values, values), {}, {}});
    writer->finish();
  }
}

TEST(MitsubaComparison, EqualImagesPassAndBiasedOnesFail) {
  const Rendering ours{noise(1), 1.5, 0, false};
  const MitsubaScene same = compare_with_mitsuba(kBox, "cpu", ours, noise(2), 1e-6);
  EXPECT_TRUE(same.passed) << same.failure;
  EXPECT_EQ(same.failure, "");
  EXPECT_EQ(same.entry["channels_nm"].size(), ours.image.channels);
  EXPECT_NEAR(same.entry["ours"][0].get<double>(), 100, 0.1);
  EXPECT_EQ(same.entry["samples_theirs"], 8);
  EXPECT_EQ(same.entry["seconds_ours"], 1.5);
  EXPECT_TRUE(same.entry["pixels"].is_null());
  const double seen = same.figure("/detectable/typical");
  EXPECT_GT(seen, 1e-5);
  EXPECT_LT(seen, 1e-3);
  EXPECT_TRUE(std::isnan(same.figure("/pixels/p")));
  const MitsubaScene biased =
      compare_with_mitsuba(kBox, "cpu", ours, noise(2, static_cast<float>(1 / (1 + 2 * seen))), 1e-6);
  EXPECT_FALSE(biased.passed);
  EXPECT_NEAR(biased.figure("/difference_all"), 2 * seen, seen / 2);
  EXPECT_LT(biased.figure("/p"), biased.figure("/level"));
  EXPECT_TRUE(biased.failure.starts_with("channel means: p ")) << biased.failure;
}

// What the image's mean does not show.
TEST(MitsubaComparison, OneWrongPixelFails) {
  stats::ReplicateImage theirs = noise(3);
  const std::size_t values = theirs.pixels() * theirs.channels;
  for (uint32_t r = 0; r < theirs.replicates; ++r) theirs.means[r * values + 100 * theirs.channels] *= 1.05f;
  const MitsubaScene scene = compare_with_mitsuba(kBox, "cpu", {noise(1), 1, 0, false}, theirs, 1e-6);
  EXPECT_FALSE(scene.passed);
  EXPECT_EQ(scene.entry["pixels"]["name"], "mean/pixel");
  EXPECT_NE(scene.failure.find("; mean/pixel: p "), std::string::npos) << scene.failure;
}

TEST(MitsubaComparison, InvalidAndInfiniteSamplesFail) {
  const MitsubaScene invalid = compare_with_mitsuba(kBox, "cpu", {noise(1), 1, 3, false}, noise(2), 1e-6);
  EXPECT_FALSE(invalid.passed);
  EXPECT_TRUE(invalid.failure.ends_with("; 3 invalid samples")) << invalid.failure;
  stats::ReplicateImage theirs = noise(2);
  theirs.means[5] = INFINITY;
  EXPECT_FALSE(compare_with_mitsuba(kBox, "cpu", {noise(1), 1, 0, false}, theirs, 1e-6).passed);
}

TEST(MitsubaComparison, ReadsTheCubes) {
  const test::TemporaryFolder folder;
  const stats::ReplicateImage image = noise(4);
  write_cubes(image, folder / "box");
  const stats::ReplicateImage read = read_mitsuba_cubes(folder / "box", 8);
  EXPECT_EQ(read.means, image.means);
  EXPECT_EQ(read.samples, image.samples);
  write_cubes(image, folder / "density", Quantity::kDensity);
  EXPECT_NE(test::error_of([&] {
              read_mitsuba_cubes(folder / "density", 8);
            }).find("not 32 x 32 pixels of 8 integrals"),
            std::string::npos);
  write_cubes(image, folder / "bands", Quantity::kIntegral, "400:708:8");
  EXPECT_NE(
      test::error_of([&] { read_mitsuba_cubes(folder / "bands", 8); }).find("channel 0 is not 400-437.5 nm"),
      std::string::npos);
  EXPECT_NE(test::error_of([&] { read_mitsuba_cubes(folder / "none", 8); }), "accepted");
}

// ---- runs ---------------------------------------------------------------------------------------------------

/// One grey square under a sky: quickly rendered.
fs::path grey_scene(const test::TemporaryFolder& folder) {
  return folder.write(
      "grey.xml",
      "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='2'/></integrator>"
      "<sensor type='orthographic'><film type='hdrfilm'><rfilter type='box'/></film></sensor>"
      "<shape type='rectangle'><transform name='to_world'><rotate y='1' angle='180'/><scale value='9'/>"
      "<translate z='1'/></transform></shape>"
      "<emitter type='constant'><spectrum name='radiance' value='1'/></emitter></scene>");
}

MitsubaRun run_of(const test::TemporaryFolder& folder, const std::vector<std::string>& scenes) {
  return {folder.path(), scenes, {"cpu", "opencl:pt"}, Effort::kStandard, 7};
}

TEST(RunMitsuba, RendersBothSides) {
  const test::TemporaryFolder folder;
  const std::string at = "'" + folder.path().string() + "'";
  const std::string python =
      with_mitsuba(folder, "echo \"$*\" >> " + at + "/arguments; cp " + at + "/box.r* " + at + "/mitsuba");
  MitsubaDriver driver = driver_of(python, {"box", "ball"});
  driver.scenes[0].file = grey_scene(folder);
  Rendering theirs = render(load({driver.scenes[0].file, {}, kMitsubaBands, kMitsubaSize, kMitsubaSize}), {},
                            {99, kMitsubaReplicates, 2}, {});
  write_cubes(theirs.image, folder / "box");
  std::vector<double> progress;
  const Watch watch{nullptr, [&](double fraction) { progress.push_back(fraction); }};
  const MitsubaResult result = run_mitsuba(driver, run_of(folder, {"box"}), watch);
  EXPECT_EQ(result.record["mitsuba"], "9.8.7");
  ASSERT_EQ(result.scenes.size(), 2u);
  EXPECT_TRUE(result.passed()) << result.scenes[0].failure << result.scenes[1].failure;
  EXPECT_EQ(result.scenes[1].backend, "opencl:pt");
  EXPECT_EQ(result.scenes[0].entry["samples_ours"], 4);  // a quarter of 16
  EXPECT_EQ(result.scenes[0].entry["samples_theirs"], 2);
  EXPECT_EQ(progress, (std::vector<double>{0.5, 1}));
  EXPECT_EQ(folder.read("arguments"), "render.py " + driver.scenes[0].file.string() +
                                          " --bands 400:700:8 -o " + (folder / "mitsuba/box.hdr").string() +
                                          " --size 32x32 --spp 2 --replicates 32 --seed 8\n");
}

// What a scene comes to does not take the others away: an hour of other cases is not lost.
TEST(RunMitsuba, WhatCouldNotBeDoneHasFailed) {
  const test::TemporaryFolder folder;
  const MitsubaResult crashed =
      run_mitsuba(driver_of(with_mitsuba(folder, "echo ValueError: no >&2; exit 2"), {"box", "ball"}),
                  run_of(folder, {"box", "ball"}), {});
  ASSERT_EQ(crashed.scenes.size(), 4u);
  EXPECT_FALSE(crashed.passed());
  EXPECT_EQ(crashed.scenes[3].name, "ball");
  EXPECT_EQ(crashed.scenes[1].failure, "render_mitsuba.py: exit code 2: ValueError: no");
  EXPECT_TRUE(std::isnan(crashed.scenes[1].figure("/p")));
  const MitsubaResult silent =
      run_mitsuba(driver_of(with_mitsuba(folder, "exit 0"), {"box"}), run_of(folder, {"box"}), {});
  ASSERT_EQ(silent.scenes.size(), 2u);
  EXPECT_NE(silent.scenes[0].failure.find("box.r00.hdr"), std::string::npos) << silent.scenes[0].failure;
  folder.write("file", "");
  MitsubaRun blocked = run_of(folder, {"box"});
  blocked.output = folder / "file";
  EXPECT_FALSE(run_mitsuba(driver_of(with_mitsuba(folder), {"box"}), blocked, {}).passed());
}

TEST(RunMitsuba, AStoppedRunHasWhatItCameTo) {
  const test::TemporaryFolder folder;
  const std::atomic<bool> stop{true};
  EXPECT_TRUE(run_mitsuba(driver_of(with_mitsuba(folder), {"box"}), run_of(folder, {"box"}), {&stop, {}})
                  .scenes.empty());
}

/// A scene against Mitsuba that fails is a failure of the run, once in each file.
TEST(RunMitsuba, IsPartOfTheResults) {
  SuiteResult result;
  EXPECT_TRUE(result.passed());
  EXPECT_FALSE(to_json(result, {}).contains("mitsuba"));
  result.mitsuba.record = {{"mitsuba", "9.8.7"}};
  result.mitsuba.scenes = {compare_with_mitsuba(kBox, "cpu", {noise(1), 1.5, 0, false}, noise(2), 1e-6),
                           {"box", "opencl:pt", false, "exit code 2: no <device>", {}}};
  EXPECT_FALSE(result.passed());
  const json section = to_json(result, {})["mitsuba"];
  EXPECT_EQ(section["mitsuba"], "9.8.7");
  ASSERT_EQ(section["scenes"].size(), 2u);
  EXPECT_EQ(section["scenes"][0]["passed"], true);
  EXPECT_EQ(section["scenes"][0]["what"], "a box");
  EXPECT_FALSE(section["scenes"][1].contains("p"));
  EXPECT_EQ(section["scenes"][1]["failure"], "exit code 2: no <device>");
  const std::string junit = to_junit(result);
  EXPECT_NE(junit.find("tests=\"2\" failures=\"1\""), std::string::npos) << junit;
  EXPECT_NE(junit.find("<testcase classname=\"mitsuba/box\" name=\"cpu\" time=\"1.500\"/>"),
            std::string::npos)
      << junit;
  EXPECT_NE(junit.find("exit code 2: no &lt;device&gt;"), std::string::npos) << junit;
}

}  // namespace
}  // namespace kiloband::validation
