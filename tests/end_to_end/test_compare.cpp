// `kiloband compare`: renders of one scene agree, changed ones do not; what it says and refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test {
namespace {

/// 16 x 16 pixels of the Cornell box in 3 channels.
void render(const TemporaryFolder& folder, const std::string& out, const std::string& seed,
            const std::vector<std::string>& more = {"--keep-replicates"}) {
  std::vector<std::string> arguments{"--size", "16x16",  "--bands", "450:650:3", "--spp",
                                     "64",     "--seed", seed,      "-o",        out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = run_program(folder, quiet_render(cornell_box(), arguments));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
}

/// The cube and its replicates times a factor.
void scale_cube(const TemporaryFolder& folder, const std::string& from, const std::string& to, float factor,
                uint32_t replicates) {
  for (int r = -1; r < static_cast<int>(replicates); ++r) {
    const std::string suffix = r < 0 ? "" : (r < 10 ? ".r0" : ".r") + std::to_string(r);
    Cube cube = read_cube(folder / (from + suffix + ".hdr"));
    for (float& value : cube.mean) value *= factor;
    for (float& value : cube.variance) value *= factor * factor;
    auto writer = create_cube_writer(folder / (to + suffix + ".hdr"), cube.info, cube.info.height);
    writer->write_rows({0, cube.info.height, cube.mean, cube.variance, cube.aux});
    writer->finish();
  }
}

/// Of a channel.
double image_mean(const Cube& cube, std::size_t channel) {
  const std::size_t channels = cube.info.bands.size();
  double sum = 0;
  for (std::size_t i = channel; i < cube.mean.size(); i += channels) sum += cube.mean[i];
  return sum / static_cast<double>(cube.pixels());
}

/// The verdict says what it would have found, in the text as in the JSON.
void expect_detectable(const std::string& text, const nlohmann::json& json) {
  EXPECT_TRUE(json["passed"]);
  EXPECT_EQ(json["power"], 0.9);
  expect_text(
      text,
      "detectable bias: from these differences on, relative to the mean of A there, a difference is found "
      "with a probability of 90 % or more, at a rate of false alarms of 0.001 for all tests together\n");
  const auto percent = [](const nlohmann::json& share) {
    return fmt::format("{:.2g} %", 100 * share.get<double>());
  };
  for (const auto& [scale, typical] :
       {std::pair{"image", "in the median channel"}, std::pair{"tile", "of the median value"},
        std::pair{"pixel", "of the median value"}}) {
    const auto& bias = json["detectable_bias"][scale];
    ASSERT_TRUE(bias["median"].is_number()) << scale;
    EXPECT_GT(bias["median"].get<double>(), 0);
    EXPECT_GE(bias["worst"].get<double>(), bias["median"].get<double>());
    const auto& channel = json["channels"][bias["worst_channel"].get<std::size_t>()];
    EXPECT_EQ(bias["worst_channel_name"], channel["name"]);
    expect_text(text, fmt::format("  {:<5}  {} {}, {} in the worst ({})\n", scale, percent(bias["median"]),
                                  typical, percent(bias["worst"]), channel["name"].get<std::string>()));
  }
}

/// Level of a comparison: 1e-3, so a right program fails with probability 2e-3 at most,
/// for any seeds; these are fixed.
TEST(Compare, OtherSeedsAgreeAndHalfAsMuchAgainIsFound) {
  const TemporaryFolder folder;
  render(folder, "a.hdr", "1");
  render(folder, "b.hdr", "2");
  const Outcome same = compare(folder, {"a.hdr", "b.hdr", "--json", "same.json"});
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  expect_text(same.out,
              "A: a.hdr, 16 replicates\nB: b.hdr, 16 replicates\n16x16 pixels, 3 channels, independent, "
              "alpha 0.001\n");
  expect_text(same.out, "no difference found\n");
  const auto unscaled = read_json(folder, "same.json");
  expect_detectable(same.out, unscaled);

  scale_cube(folder, "b", "c", 1.5f, 16);
  const Outcome other = compare(folder, {"a.hdr", "c.hdr", "--json", "other.json"});
  EXPECT_EQ(other.code, 1) << other.err;
  expect_text(other.out, "DIFFERENT: ");
  const auto json = read_json(folder, "other.json");
  EXPECT_FALSE(json["passed"]);
  EXPECT_EQ(json["tests"].size(), 7u);
  ASSERT_EQ(json["channels"].size(), 3u);
  for (std::size_t c = 0; c < 3; ++c) {
    for (const char* name : {"a", "c"}) {
      const double mean = image_mean(read_cube(folder / (std::string(name) + ".hdr")), c);
      EXPECT_NEAR(json["channels"][c][*name == 'a' ? "mean_a" : "mean_b"].get<double>(), mean, 1e-6 * mean);
    }
  }
  // Not exactly: what variances are taken about, and the weights of pixels, are of both sides.
  const double ratio = unscaled["variance_ratio"]["ratio"];
  EXPECT_NEAR(json["variance_ratio"]["ratio"].get<double>(), ratio / 2.25, 0.04 * ratio / 2.25);
  EXPECT_LT(std::abs(std::log(ratio)), 4 * unscaled["variance_ratio"]["log_standard_error"].get<double>());

  const Outcome image = compare(folder, {"a.hdr", "c.hdr", "--image-only", "--json", "image.json"});
  EXPECT_EQ(image.code, 1) << image.out << image.err;
  const auto tests = read_json(folder, "image.json")["tests"];
  ASSERT_EQ(tests.size(), 1u);
  EXPECT_EQ(tests[0]["name"], "mean/image");
  EXPECT_EQ(compare(folder, {"a.hdr", "b.hdr", "--image-only"}).code, 0);
}

/// Equal seeds, paired: 1 % is far above the rounding, equal files are equal.
TEST(Compare, PairsOfEqualSeed) {
  const TemporaryFolder folder;
  render(folder, "a.hdr", "1");
  scale_cube(folder, "a", "c", 1.01f, 16);
  EXPECT_EQ(compare(folder, {"a.hdr", "a.hdr", "--paired"}).code, 0);
  const Outcome other = compare(folder, {"a.hdr", "c.hdr", "--paired"});
  EXPECT_EQ(other.code, 1) << other.out;
  const Outcome unpaired = compare(folder, {"a.hdr", "c.hdr"});
  EXPECT_EQ(unpaired.code, 0) << "the noise is larger";
  expect_text(unpaired.err, "warning: A and B have the same seed 1: ");
}

/// Densities (EXR) against integrals (ENVI); several renders; variances; the truth.
TEST(Compare, EveryKindOfCube) {
  const TemporaryFolder folder;
  render(folder, "a.hdr", "1", {"--variance", "-o", "a.exr"});
  render(folder, "b.exr", "2", {"--variance"});
  for (int i = 0; i < 4; ++i) {
    render(folder, "m" + std::to_string(i) + ".hdr", std::to_string(10 + i), {});
    render(folder, "n" + std::to_string(i) + ".exr", std::to_string(20 + i), {});
  }
  const Outcome variances = compare(folder, {"a.hdr", "b.exr"});
  EXPECT_EQ(variances.code, 0) << variances.out << variances.err;
  expect_text(variances.out, "A: a.hdr, variances with 15 degrees of freedom\n");
  expect_text(variances.out, "note: variances were not compared: that needs replicates or several renders\n");
  const Outcome renders = compare(folder, {"m0.hdr,m1.hdr,m2.hdr,m3.hdr", "n0.exr,n1.exr,n2.exr,n3.exr"});
  EXPECT_EQ(renders.code, 0) << renders.out << renders.err;
  expect_text(renders.out, "A: 4 independent renders\n");
  expect_text(renders.out, "note: 4 replicates on a side: 32 or more are wanted");
  EXPECT_EQ(compare(folder, {"a.hdr", "n0.exr,n1.exr,n2.exr"}).code, 0) << "variances against renders";
  const Outcome truth = compare(folder, {"a.hdr", "a.exr", "--b-exact"});
  EXPECT_EQ(truth.code, 0) << truth.out;
  expect_text(truth.out, "B: a.exr, taken as exact\n");
  scale_cube(folder, "a", "c", 3, 0);
  EXPECT_EQ(compare(folder, {"a.hdr", "c.hdr", "--dof-b", "15", "--independent-pixels"}).code, 1);
}

/// 2 x 2 pixels in one channel of 100 nm; the values are integrals.
void write_small_cube(const std::filesystem::path& file, float value, std::optional<float> variance = {},
                      Quantity quantity = Quantity::kIntegral) {
  CubeInfo info;
  info.width = info.height = 2;
  info.bands = {{{400, 500, ""}, false}};
  info.variance = variance.has_value();
  info.quantity = quantity;
  auto writer = create_cube_writer(file, info, 2);
  const std::vector<float> values{value, 2 * value, value, value},
      variances(variance ? 4 : 0, variance.value_or(0));
  writer->write_rows({0, 2, values, variances, {}});
  writer->finish();
}

/// A variance that no float holds is 0 in the file: nothing is known of such a difference. Of a mean of 1 it
/// says that there is no noise.
TEST(Compare, VariancesThatAFileCannotHold) {
  const TemporaryFolder folder;
  for (const auto& [name, value, variance] :
       {std::tuple{"a.hdr", 1e-24f, 0.0f}, std::tuple{"b.hdr", 1.1e-24f, 0.0f},
        std::tuple{"tiny_a.exr", 2e-23f, 1e-45f}, std::tuple{"tiny_b.exr", 1.9e-23f, 0.0f},
        std::tuple{"one.hdr", 1.0f, 0.0f}, std::tuple{"more.hdr", 1.1f, 0.0f}})
    write_small_cube(folder / name, value, variance);
  EXPECT_EQ(compare(folder, {"a.hdr", "b.hdr"}).code, 0);
  EXPECT_EQ(compare(folder, {"tiny_a.exr", "tiny_b.exr"}).code, 0);
  EXPECT_EQ(compare(folder, {"one.hdr", "more.hdr"}).code, 1);
}

/// A cube of variances has a quantity of its own: variances 1 of integrals over 100 nm are 10^-4 of densities.
TEST(Compare, VariancesInTheQuantityOfTheirCube) {
  const TemporaryFolder folder;
  write_small_cube(folder / "a.hdr", 10);
  write_small_cube(folder / "b.hdr", 12);
  write_small_cube(folder / "integrals.hdr", 1);
  write_small_cube(folder / "densities.hdr", 1e-2f, {}, Quantity::kDensity);  // writers divide by the width
  std::vector<std::string> p;
  for (const char* variances : {"integrals.hdr", "densities.hdr"}) {
    const Outcome outcome = compare(folder, {"a.hdr", "b.hdr", "--variance-a", variances, "--variance-b",
                                             variances, "--json", "result.json"});
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    p.push_back(fmt::format("{:.4f}", read_json(folder, "result.json")["tests"][0]["p"].get<double>()));
  }
  EXPECT_EQ(p[0], p[1]);
}

/// Names of files and of bands have any bytes (here Latin-1's e with an acute accent); JSON has UTF-8 alone.
TEST(Compare, NamesThatAreNoUtf8) {
  const TemporaryFolder folder;
  write_small_cube(folder / "d\xe9.hdr", 1, 0.01f);
  const Outcome outcome = compare(folder, {"d\xe9.hdr", "d\xe9.hdr", "--json", "result.json"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_json(folder, "result.json")["a"].get<std::string>().find("d\xef\xbf\xbd.hdr, "), 0u);
}

/// Longer than a file name may be (255 bytes), and than a path (4096).
TEST(Compare, ListsOfAnyLength) {
  const TemporaryFolder folder;
  std::string list, missing;
  for (int i = 0; i < 40; ++i) {
    const std::string name = std::string(110, 'n') + std::to_string(i) + ".hdr";
    write_small_cube(folder / name, 1 + 0.01f * static_cast<float>(i % 7));
    list += (i > 0 ? "," : "") + name;
    missing += (i > 0 ? ",a_" : "a_") + std::to_string(i) + ".hdr";
  }
  const Outcome outcome = compare(folder, {list, list, "--paired"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  expect_text(outcome.out, "A: 40 independent renders\nB: 40 independent renders\n");
  expect_refused(folder, {"compare"},
                 {
                     {{missing, list}, "cannot open 'a_0.hdr': No such file or directory"},
                     {{list, "a.hdr,,b.hdr"}, "B 'a.hdr,,b.hdr': a name in the list is empty"},
                 });
}

TEST(Compare, WrongInput) {
  const TemporaryFolder folder;
  folder.write("scene.xml", complete_scene(""));
  const auto make = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--spp", "4", "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_EQ(run_program(folder, quiet_render("scene.xml", arguments)).code, 0);
  };
  make("a.hdr", {"--bands", "400:700:4", "--variance"});
  make("plain.hdr", {"--bands", "400:700:4"});
  make("three.hdr", {"--bands", "400:700:3", "--variance"});
  make("other.hdr", {"--bands", "400:720:4", "--variance"});
  make("small.hdr", {"--bands", "400:700:4", "--size", "4x8", "--variance"});
  expect_refused(
      folder, {"compare"},
      {
          {{"a.hdr"}, "B is required (see kiloband compare --help)"},
          {{"a.hdr", "small.hdr"}, "A has 8x8 pixels, B has 4x8"},
          {{"a.hdr", "three.hdr"}, "A has 4 channels, B has 3"},
          {{"a.hdr", "other.hdr"}, "channel 0: A has 400-475 nm, B has 400-480 nm"},
          {{"plain.hdr", "a.hdr"},
           "plain.hdr: has neither variances nor replicates: render with --variance or "
           "--keep-replicates, give "
           "several renders as FILE,FILE,..."},
          {{"a.hdr", "plain.hdr"},
           "plain.hdr: has neither variances nor replicates: render with --variance or "
           "--keep-replicates, give "
           "several renders as FILE,FILE,..., or --b-exact if B is the truth"},
          {{"a.hdr,plain.hdr", "a.hdr"},
           "a.hdr and plain.hdr have the same seed 0: they are not independent renders"},
          {{"a.hdr,other.hdr,./a.hdr", "a.hdr"},
           "a.hdr and ./a.hdr are one file: they are not independent renders"},
          {{"a.hdr,three.hdr", "a.hdr"}, "a.hdr has 4 channels, three.hdr has 3"},
          {{"a.hdr,plain.hdr", "a.hdr", "--variance-a", "a.hdr"},
           "A: --variance-a, --dof-a are for a single cube, these are 2 renders"},
          {{"a.hdr", "plain.hdr", "--b-exact", "--variance-b", "none.hdr"},
           "--b-exact: B then has no errors, which --variance-b and --dof-b would describe"},
          {{"a.hdr", "plain.hdr", "--b-exact", "--dof-b", "3"},
           "--b-exact: B then has no errors, which --variance-b and --dof-b would describe"},
          {{"a.hdr", "plain.hdr", "--variance-b", "three.hdr"}, "plain.hdr has 4 channels, three.hdr has 3"},
          {{"a.hdr", "a.hdr", "--paired"},
           "--paired needs as many replicates (or renders) of A as of B: A has none, B has none"},
          {{"a.hdr", "a.hdr", "--image-only"},
           "--image-only needs replicates (--keep-replicates) or several renders of both sides"},
          {{"a.hdr", "a.hdr", "--alpha", "1"}, "--alpha 1: must be above 0 and below 1"},
          {{"a.hdr", "a.hdr", "--rounding", "2"}, "--rounding 2: must be at least 0 and below 1"},
          {{"a.hdr", "a.hdr", "--dof-a", "0"}, "--dof-a 0: must be at least 1"},
          {{"none.hdr", "a.hdr"}, "cannot open 'none.hdr': No such file or directory"},
      });
}

}  // namespace
}  // namespace kiloband::test
