// `kiloband compare` where values are missing or not finite,
// and where nothing says how many samples a cube has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/end_to_end/wrong_input/wrong_input.hpp"

namespace kiloband::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr uint32_t kEdge = 8;
constexpr std::size_t kBands = 2, kValues = kEdge * kEdge * kBands;

using Image = std::vector<float>;  // [pixel][band]

/// Normal to the eye (sums of 12 uniform numbers): mean 10, standard deviation `spread`.
std::vector<Image> noise(uint32_t seed, std::size_t count, double spread = 1) {
  std::mt19937 random(seed);
  std::vector<Image> images(count, Image(kValues));
  for (Image& image : images) {
    for (float& value : image) {
      double sum = -6;
      for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
      value = static_cast<float>(10 + spread * sum);
    }
  }
  return images;
}

void blank(Image& image, std::size_t first, std::size_t count) {
  std::fill_n(image.begin() + static_cast<std::ptrdiff_t>(first * kBands), count * kBands, kNaN);
}

CubeInfo info_of(uint64_t samples_per_pixel) {
  CubeInfo info;
  info.width = info.height = kEdge;
  info.bands = {{{400, 500, ""}, false}, {{500, 600, ""}, false}};
  info.samples_per_pixel = samples_per_pixel;
  return info;
}

void write(const TemporaryFolder& folder, const std::string& name, const CubeInfo& info, const Image& mean,
           const Image& variance = {}) {
  auto writer = create_cube_writer(folder / name, info, kEdge);
  writer->write_rows({0, kEdge, mean, variance, {}});
  writer->finish();
}

/// As several renders; 0 samples: it is not said how many. Returns "a0.hdr,a1.hdr,...".
std::string write_renders(const TemporaryFolder& folder, const std::string& stem,
                          const std::vector<Image>& images, uint64_t samples_per_pixel = 64) {
  std::string names;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::string name = stem + std::to_string(i) + ".hdr";
    write(folder, name, info_of(samples_per_pixel), images[i]);
    names += (names.empty() ? "" : ",") + name;
  }
  return names;
}

/// As a cube with its replicates, 4 samples each. Returns its name.
std::string write_replicates(const TemporaryFolder& folder, const std::string& stem,
                             const std::vector<Image>& images) {
  CubeInfo info = info_of(4 * images.size());
  Image mean(kValues);
  for (std::size_t i = 0; i < kValues; ++i) {
    float count = 0;
    for (const Image& image : images) {
      if (std::isnan(image[i])) continue;
      mean[i] += image[i];
      ++count;
    }
    mean[i] /= count;
  }
  for (std::size_t r = 0; r < images.size(); ++r) {
    info.replicates = 1;
    info.metadata["replicate"] = std::to_string(r);
    write(folder, stem + (r < 10 ? ".r0" : ".r") + std::to_string(r) + ".hdr", info, images[r]);
  }
  info.replicates = static_cast<uint32_t>(images.size());
  info.metadata.clear();
  write(folder, stem + ".hdr", info, mean);
  return stem + ".hdr";
}

std::string write_variances(const TemporaryFolder& folder, const std::string& name, const Image& mean,
                            const Image& variance) {
  CubeInfo info = info_of(64);
  info.variance = true;
  info.replicates = 16;
  write(folder, name, info, mean, variance);
  return name;
}

void expect_no_text(const std::string& text, const std::string& part) {
  EXPECT_EQ(text.find(part), std::string::npos) << part << " is in: " << text;
}

TEST(CompareGaps, APixelWithoutValuesInSomeRendersIsADifference) {
  const TemporaryFolder folder;
  std::vector<Image> images = noise(1, 4);
  const std::string right = write_renders(folder, "right", images);
  blank(images[1], 5, 1);
  const std::string wrong = write_renders(folder, "wrong", images);
  const std::string unknown = write_renders(folder, "unknown", images, 0);
  const std::string b = write_replicates(folder, "b", noise(2, 16));
  const std::string v = write_variances(folder, "v.hdr", Image(kValues, 10), Image(kValues, 0.1f));
  for (const std::string& other : {b, v}) {
    EXPECT_EQ(compare(folder, {right, other}).code, 0);
    for (const std::string& a : {wrong, unknown}) {
      const Outcome outcome = compare(folder, {a, other});
      EXPECT_EQ(outcome.code, 1) << outcome.out << outcome.err;
      expect_text(outcome.out, "DIFFERENT: finite ");
    }
  }
  expect_text(compare(folder, {wrong, b}).out, "note: 1 replicate means of pixels are not finite\n");
}

/// Pixels that a render did not reach lack their last replicates.
TEST(CompareGaps, AnInterruptedRenderLacksItsLastReplicates) {
  const TemporaryFolder folder;
  std::vector<Image> images = noise(1, 16);
  blank(images[14], 40, 24);
  blank(images[15], 0, 64);
  const std::string a = write_replicates(folder, "a", images);
  const std::string b = write_replicates(folder, "b", noise(2, 16));
  const std::string v = write_variances(folder, "v.hdr", Image(kValues, 10), Image(kValues, 0.1f));
  for (const std::string& other : {b, v}) {
    const Outcome outcome = compare(folder, {a, other, "--json", "result.json"});
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    expect_text(
        outcome.out,
        "note: 88 replicate means of pixels have no samples (an interrupted render) and were left out\n");
    EXPECT_EQ(read_json(folder, "result.json")["missing_replicate_means"], 88);
  }
  expect_text(compare(folder, {a, b}).out,
              "note: variances were not compared: nothing says how many samples the replicates of A have\n");
  EXPECT_EQ(compare(folder, {b, b, "--paired", "--json", "result.json"}).code, 0);
  EXPECT_EQ(read_json(folder, "result.json")["missing_replicate_means"], 0);

  blank(images[3], 10, 1);  // later ones were rendered: no interruption
  const Outcome outcome = compare(folder, {write_replicates(folder, "c", images), b});
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  expect_text(outcome.out, "note: 1 replicate means of pixels are not finite\n");
}

TEST(CompareGaps, TheTruthIsNotFinite) {
  const TemporaryFolder folder;
  std::vector<Image> images = noise(1, 16);
  const std::string a = write_replicates(folder, "a", images);
  Image truth(kValues, 10);
  write(folder, "right.hdr", info_of(0), truth);
  blank(truth, 7, 1);
  write(folder, "wrong.hdr", info_of(0), truth);
  EXPECT_EQ(compare(folder, {a, "right.hdr", "--b-exact"}).code, 0);
  const Outcome found = compare(folder, {a, "wrong.hdr", "--b-exact"});
  EXPECT_EQ(found.code, 1) << found.out << found.err;
  expect_text(found.out, "DIFFERENT: finite ");
  for (Image& image : images) blank(image, 7, 1);
  const std::string absent = write_replicates(folder, "absent", images);
  const Outcome both = compare(folder, {absent, "wrong.hdr", "--b-exact"});
  EXPECT_EQ(both.code, 0) << both.out << both.err;
  expect_text(both.out, "note: 1 pixels have no values on either side\n");
  expect_text(compare(folder, {absent, "right.hdr", "--b-exact"}).out, "DIFFERENT: finite ");
}

TEST(CompareGaps, NothingToCompare) {
  const TemporaryFolder folder;
  std::vector<Image> images = noise(1, 16);
  Image variance(kValues, 0.1f);
  variance[3] = std::numeric_limits<float>::infinity();
  write_variances(folder, "one.hdr", images[0], variance);
  const Outcome one = compare(folder, {"one.hdr", "one.hdr"});
  EXPECT_EQ(one.code, 0) << one.out << one.err;
  expect_text(one.out, "note: pixels: 1 values have no error on a side and were not compared\n");
  write_variances(folder, "none.hdr", images[0], Image(kValues, variance[3]));
  for (Image& image : images) blank(image, 0, kEdge * kEdge);
  write_replicates(folder, "a", images);
  const std::string message = "no pixel has values and errors on both sides: there is nothing to compare";
  expect_refused(folder, {"compare"},
                 {
                     {{"none.hdr", "none.hdr"}, message},
                     {{"a.hdr", "a.hdr", "--paired"}, message},
                 });
}

/// Renders of what has no noise, such as a furnace: constants are a comparison, but none that could state a bias.
TEST(CompareGaps, MeansWithoutNoiseAreComparedAsTheyAre) {
  const TemporaryFolder folder;
  write_variances(folder, "ten.hdr", Image(kValues, 10), Image(kValues, 0));
  write_variances(folder, "near.hdr", Image(kValues, 10.00005f), Image(kValues, 0));
  write_variances(folder, "far.hdr", Image(kValues, 10.001f), Image(kValues, 0));
  for (const std::string other : {"ten.hdr", "near.hdr"}) {
    const Outcome same = compare(folder, {"ten.hdr", other});
    EXPECT_EQ(same.code, 0) << same.out << same.err;
    expect_text(
        same.out,
        "detectable bias: none to state, the means that were compared vary on neither side, or are 0 in A\n");
  }
  EXPECT_EQ(compare(folder, {"ten.hdr", "far.hdr"}).code, 1);
}

/// Twice the spread, as 64 samples have it against 256: it tells the sides apart only if both say that they
/// have equally many.
TEST(CompareGaps, VariancesNeedCountsOfSamples) {
  const TemporaryFolder folder;
  const std::vector<Image> few = noise(1, 12, 2), many = noise(2, 12, 1);
  const std::string a = write_renders(folder, "a", few), b = write_renders(folder, "b", many);
  const std::string u = write_renders(folder, "u", few, 0), w = write_renders(folder, "w", many, 0);
  const std::string note =
      "note: variances were not compared: nothing says how many samples the replicates of ";
  const Outcome known = compare(folder, {a, b});
  EXPECT_EQ(known.code, 1) << known.out;
  expect_no_text(known.out, note);
  const Outcome neither = compare(folder, {u, w});
  EXPECT_EQ(neither.code, 0) << neither.out;
  expect_text(neither.out, note + "A and B have\n");
  expect_text(compare(folder, {a, w}).out, note + "B have\n");
  expect_text(compare(folder, {u, b}).out, note + "A have\n");
  expect_no_text(compare(folder, {u, w, "--no-variances"}).out, note);
}

}  // namespace
}  // namespace kiloband::test
