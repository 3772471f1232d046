// What a render of the Cornell box writes: names, contents that agree between
// formats, replicates, statistics.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/end_to_end/support/program.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test {
namespace {

using Names = std::vector<std::string>;

/// 16 x 12 pixels, 6 channels of 50 nm, 32 samples.
Names small_box(const Names& more) {
  Names arguments{"-D", "spp=32", "--size", "16x12", "--bands", "400:700:6"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return quiet_render(cornell_box(), arguments);
}

void expect_same_bands(const CubeInfo& a, const CubeInfo& b) {
  ASSERT_EQ(a.bands.size(), b.bands.size());
  for (std::size_t k = 0; k < a.bands.size(); ++k) {
    EXPECT_EQ(a.bands[k].channel.min_nm, b.bands[k].channel.min_nm);
    EXPECT_EQ(a.bands[k].channel.max_nm, b.bands[k].channel.max_nm);
    EXPECT_EQ(a.bands[k].channel.name, b.bands[k].channel.name);
  }
}

uint32_t big_endian(const std::string& bytes, std::size_t at) {
  uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
  return value;
}

TEST(Outputs, FormatsAgree) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run_program(folder, small_box({"-o", "box.exr", "-o", "box.hdr", "--variance", "--preview", "box.png",
                                     "--stats", "box.json", "--aov", "depth,normal,object,material"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(folder.list(), (Names{"box.aux.hdr", "box.aux.img", "box.exr", "box.hdr", "box.img", "box.json",
                                  "box.png", "box.var.hdr", "box.var.img"}));
  const Cube exr = read_cube(folder / "box.exr");
  const Cube envi = read_cube(folder / "box.hdr");
  EXPECT_EQ(exr.info.quantity, Quantity::kDensity);
  EXPECT_EQ(envi.info.quantity, Quantity::kIntegral);
  for (const Cube* cube : {&exr, &envi}) {
    EXPECT_EQ(cube->info.width, 16u);
    EXPECT_EQ(cube->info.height, 12u);
    EXPECT_EQ(cube->info.samples_per_pixel, 32u);
    EXPECT_EQ(cube->info.replicates, 16u);
    EXPECT_EQ(cube->info.aux, (Names{"depth", "normal.X", "normal.Y", "normal.Z", "object", "material"}));
    EXPECT_EQ(cube->info.metadata.at("scene"), "cornell_box.xml");
  }
  expect_same_bands(exr.info, envi.info);
  EXPECT_EQ(exr.aux, envi.aux);
  // Densities are rounded once to float: half a unit in the last place, 6e-8.
  double sum = 0;
  for (std::size_t i = 0; i < envi.mean.size(); ++i) {
    EXPECT_NEAR(exr.mean[i] * 50, envi.mean[i], 1e-7 * envi.mean[i]);
    EXPECT_NEAR(exr.variance[i] * 2500, envi.variance[i], 1e-7 * envi.variance[i]);
    EXPECT_GE(envi.variance[i], 0);
    sum += envi.mean[i];
  }
  EXPECT_GT(sum, 0);
}

TEST(Outputs, AuxiliaryImagesDescribeTheBox) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, small_box({"-o", "box.hdr", "--aov", "depth,normal,object"})).code, 0);
  const Cube cube = read_cube(folder / "box.hdr");
  ASSERT_EQ(cube.info.aux.size(), 5u);
  for (std::size_t pixel = 0; pixel < cube.pixels(); ++pixel) {
    const float* aux = &cube.aux[5 * pixel];
    if (aux[4] < 0) continue;  // beside the box: 16 x 12 pixels show more than its opening
    // The camera is 0.8 m in front of the box, whose diagonal is below 1 m.
    EXPECT_GT(aux[0], 0.75f);
    EXPECT_LT(aux[0], 2.0f);
    EXPECT_NEAR(std::hypot(aux[1], aux[2], aux[3]), 1, 1e-5);
    EXPECT_LT(aux[4], 8);
  }
}

/// Integrators of the scene that add images do what the options do; the command line overrides.
TEST(Outputs, WhatTheScenesIntegratorsAskFor) {
  const TemporaryFolder folder;
  folder.write(
      "asks.xml",
      complete_scene(R"(<integrator type="aov"><string name="aovs" value="d:depth,n:sh_normal"/>)"
                     R"(<integrator type="moment"><integrator type="path"/></integrator></integrator>)"));
  const auto render = [&](Names more) {
    more.insert(more.end(), {"-o", "a.hdr", "--spp", "32", "--bands", "400:700:2"});
    EXPECT_EQ(run_program(folder, quiet_render("asks.xml", more)).code, 0);
    return read_cube(folder / "a.hdr");
  };
  const Cube asked = render({});
  EXPECT_TRUE(asked.info.variance);
  EXPECT_EQ(asked.info.aux, (Names{"depth", "normal.X", "normal.Y", "normal.Z"}));
  const Cube other = render({"--aov", "object"});
  EXPECT_TRUE(other.info.variance);
  EXPECT_EQ(other.info.aux, Names{"object"});
  EXPECT_EQ(other.mean, asked.mean);
  EXPECT_FALSE(render({"--replicates", "1"}).info.variance);  // there is none
}

TEST(Outputs, PreviewIsAPngOfTheImagesSize) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, small_box({"-o", "box.hdr", "--preview", "box.PNG"})).code, 0);
  const std::string png = folder.read("box.PNG");
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(big_endian(png, 16), 16u);
  EXPECT_EQ(big_endian(png, 20), 12u);
  EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND");
}

TEST(Outputs, QuantityOverridesTheFormatsDefault) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, small_box({"-o", "box.exr", "-o", "box.hdr", "-o", "upper.EXR", "--quantity",
                                           "density"}))
                .code,
            0);
  const Cube exr = read_cube(folder / "box.exr");
  const Cube envi = read_cube(folder / "box.hdr");
  EXPECT_EQ(envi.info.quantity, Quantity::kDensity);
  EXPECT_EQ(exr.mean, envi.mean);
  EXPECT_EQ(read_cube(folder / "upper.EXR").mean, exr.mean);
}

/// X.HDR would stand beside the data of X.hdr.
TEST(Outputs, EnviHeadersHaveSmallLetters) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(folder, small_box({"-o", "x.HDR"}));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err,
            "kiloband: 'x.HDR': an ENVI header that is written must end in .hdr, in small letters\n");
  EXPECT_EQ(folder.list(), std::vector<std::string>{});
}

/// The data and the parts of a header that a link leads to stand beside it, and are found by both names.
TEST(Outputs, LinkedHeadersHaveTheirDataBesideThem) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  std::filesystem::create_symlink("sub/x.hdr", folder / "l.hdr");
  for (int again = 0; again < 2; ++again)
    ASSERT_EQ(run_program(folder, small_box({"-o", "l.hdr", "--variance", "--aov", "depth"})).code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "l.hdr"));
  for (const char* name : {"x.hdr", "x.img", "x.var.hdr", "x.var.img", "x.aux.hdr", "x.aux.img"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / "sub" / name)) << name;
  const Cube a = read_cube(folder / "l.hdr"), b = read_cube(folder / "sub/x.hdr");
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.aux, b.aux);
}

TEST(Outputs, ExtensionsInCapitalsMeanTheSame) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, small_box({"-o", "a.EXR", "-o", "b.exr"})).code, 0);
  EXPECT_EQ(read_cube(folder / "a.EXR").info.quantity, Quantity::kDensity);
  EXPECT_EQ(read_cube(folder / "a.EXR").mean, read_cube(folder / "b.exr").mean);
}

/// With 4 replicates of 8 samples, the result is the plain mean of the replicate files,
/// and its variance s^2 / 4.
TEST(Outputs, KeptReplicatesGiveTheMeanAndItsVariance) {
  const TemporaryFolder folder;
  const Outcome outcome = run_program(
      folder, small_box({"-o", "box.hdr", "--variance", "--keep-replicates", "--replicates", "4"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Cube box = read_cube(folder / "box.hdr");
  std::vector<Cube> replicates;
  for (int r = 0; r < 4; ++r)
    replicates.push_back(read_cube(folder / ("box.r0" + std::to_string(r) + ".hdr")));
  EXPECT_EQ(folder.list().size(), 4u + 2 * 4);
  for (std::size_t i = 0; i < box.mean.size(); ++i) {
    double sum = 0, squares = 0;
    for (const Cube& replicate : replicates) sum += replicate.mean[i];
    const double mean = sum / 4;
    for (const Cube& replicate : replicates)
      squares += (replicate.mean[i] - mean) * (replicate.mean[i] - mean);
    // Floats of 24 bits: the mean to some 1e-7; the variance loses what cancels in replicate - mean.
    EXPECT_NEAR(box.mean[i], mean, 1e-6 * mean);
    EXPECT_NEAR(box.variance[i], squares / 3 / 4, 1e-5 * squares + 1e-6 * mean * std::sqrt(squares));
  }
}

TEST(Outputs, StatisticsHaveTheNamesOfTheContract) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, small_box({"-o", "box.hdr", "--variance", "--stats", "s.json", "--seed", "7",
                                           "--threads", "1"}))
                .code,
            0);
  const nlohmann::json stats = read_json(folder, "s.json");
  const Names contract{"backend",
                       "device",
                       "isa",
                       "method",
                       "wavelengths",
                       "sampler",
                       "seed",
                       "replicates",
                       "width",
                       "height",
                       "channels",
                       "spp",
                       "seconds",
                       "setup_seconds",
                       "output_seconds",
                       "paths",
                       "paths_per_second",
                       "vertices",
                       "rays",
                       "peak_memory_bytes",
                       "device_memory_bytes",
                       "kernel_seconds",
                       "longest_launch_seconds",
                       "device_losses",
                       "invalid_samples",
                       "resumed_samples",
                       "mean_relative_error"};
  Names expected = contract;
  expected.insert(expected.end(), {"kernel_launches", "pool_slots", "underflowed_values",
                                   "underflowed_variances", "overflowed_values", "overflowed_variances",
                                   "streamed", "interrupted", "features", "ended_by", "worst_relative_error",
                                   "worst_channel", "median_relative_error", "dark_channels"});
  std::sort(expected.begin(), expected.end());
  Names found;
  for (const auto& [name, value] : stats.items()) found.push_back(name);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
  EXPECT_EQ(stats["backend"], "cpu");
  EXPECT_EQ(stats["wavelengths"], "shared");
  EXPECT_EQ(stats["sampler"], "sobol");
  EXPECT_EQ(stats["seed"], 7);
  EXPECT_EQ(stats["replicates"], 16);
  EXPECT_EQ(stats["width"], 16);
  EXPECT_EQ(stats["height"], 12);
  EXPECT_EQ(stats["channels"], 6);
  EXPECT_EQ(stats["spp"], 32);
  EXPECT_EQ(stats["paths"], 16 * 12 * 32);
  EXPECT_EQ(stats["invalid_samples"], 0);
  EXPECT_EQ(stats["interrupted"], false);
  EXPECT_GT(stats["vertices"].get<uint64_t>(), stats["paths"].get<uint64_t>());
  EXPECT_GT(stats["rays"].get<uint64_t>(), stats["paths"].get<uint64_t>());
  EXPECT_GT(stats["seconds"].get<double>(), 0);
  EXPECT_GT(stats["peak_memory_bytes"].get<uint64_t>(), uint64_t{1} << 20);
  EXPECT_GT(stats["mean_relative_error"].get<double>(), 0);
  EXPECT_LT(stats["mean_relative_error"].get<double>(), 1);
  EXPECT_EQ(stats["worst_relative_error"], stats["mean_relative_error"]);
  EXPECT_LE(stats["median_relative_error"], stats["worst_relative_error"]);
  EXPECT_EQ(stats["dark_channels"], 0);
  EXPECT_EQ(stats["ended_by"], "spp");
}

/// Not that of the program that starts it, which here is larger.
TEST(Outputs, PeakMemoryIsTheProgramsOwn) {
  if (kAddressSanitizer || kThreadSanitizer) GTEST_SKIP() << "sanitizers have memory of their own";
  constexpr std::size_t kLarge = std::size_t{600} << 20;
  const std::vector<char> large(kLarge, 1);
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, small_box({"-o", "box.hdr", "--stats", "s.json"})).code, 0);
  EXPECT_LT(read_json(folder, "s.json")["peak_memory_bytes"].get<uint64_t>(), kLarge / 2) << large.back();
}

TEST(Outputs, DefaultNameIsTheScenesStem) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_program(folder, small_box({})).code, 0);
  EXPECT_EQ(folder.list(), Names{"cornell_box.exr"});
}

TEST(Outputs, MessagesGoToStandardError) {
  const TemporaryFolder folder;
  const Outcome quiet = run_program(folder, small_box({"-o", "box.hdr"}));
  EXPECT_EQ(quiet.out, "");
  EXPECT_EQ(quiet.err, "");
  const Outcome loud =
      run_program(folder, {"render", cornell_box(), "--size", "16x12", "--spp", "4", "-o", "box.hdr"});
  EXPECT_EQ(loud.code, 0);
  EXPECT_EQ(loud.out, "");
  for (const char* text : {"backend cpu (", "100 %", "768 paths in ", "wrote box.hdr"}) {
    EXPECT_NE(loud.err.find(text), std::string::npos) << text << " is not in: " << loud.err;
  }
}

}  // namespace
}  // namespace kiloband::test
