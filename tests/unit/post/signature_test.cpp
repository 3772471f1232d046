// Cameras, masks, replicates and signatures of cubes with known contents.
#include "post/signature.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "post/convert.hpp"
#include "tests/unit/cube/cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

CameraGeometry wide_camera() {
  return {false, 0, 40, 30, 0, 0, 0.7, 0.05, -0.1};
}

/// The pixels of a film cover the pyramid over it: 4 atan(a b / sqrt(1 + a^2 + b^2)) for half widths a and b,
/// by four quarters where the principal point is not the centre.
TEST(CameraGeometry, SolidAnglesAddUpToThePyramid) {
  const CameraGeometry camera = wide_camera();
  const auto quarter = [](double a, double b) { return std::atan(a * b / std::sqrt(1 + a * a + b * b)); };
  const double left = 0.7 * (1 - 2 * 0.05), right = 0.7 * (1 + 2 * 0.05);
  const double up = 0.7 * 0.75 * (1 + 2 * 0.1), down = 0.7 * 0.75 * (1 - 2 * 0.1);
  const double exact = quarter(left, up) + quarter(right, up) + quarter(left, down) + quarter(right, down);
  double sum = 0;
  for (uint32_t y = 0; y < 30; ++y)
    for (uint32_t x = 0; x < 40; ++x) sum += camera.pixel_weight(x, y);
  EXPECT_NEAR(sum, exact, exact * 0.035 * 0.035);  // the documented bound, a^2 with a = 1.4 / 40
  EXPECT_GT(camera.pixel_weight(18, 17), camera.pixel_weight(0, 0));
}

TEST(CameraGeometry, TextComesBack) {
  for (const CameraGeometry& camera : {wide_camera(), CameraGeometry{true, 0.1 / 3}}) {
    CubeInfo info;
    info.metadata[kCameraKey] = camera.to_text();
    const auto back = camera_of_cube(info, "a.exr");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->to_text(), camera.to_text());
    EXPECT_EQ(back->pixel_weight(3, 4), camera.pixel_weight(3, 4));
  }
  CubeInfo info;
  EXPECT_FALSE(camera_of_cube(info, "a.exr"));
  for (const char* text : {"fisheye", "", "orthographic pixel_area 0", "perspective film 4 4 crop 0 0",
                           "perspective film 4 4 crop 0 0 tan_half_fov_x 1 principal 0 inf"}) {
    info.metadata[kCameraKey] = text;
    EXPECT_EQ(error_of([&] { camera_of_cube(info, "a.exr"); }),
              "a.exr: camera '" + std::string(text) + "': not understood");
  }
}

TEST(CameraGeometry, CroppedCubesKeepTheirPixels) {
  const TemporaryFolder folder;
  Cube cube = make_cube(40, 30, equal_bands(400, 500, 1));
  cube.info.metadata[kCameraKey] = wide_camera().to_text();
  for (const char* name : {"a.exr", "a.hdr"}) {
    write_cube_file(cube, folder / name, 30);
    CubeSelection selection;
    selection.crop = PixelRect{7, 11, 5, 4};
    convert_cube(folder / name, folder / "b.hdr", selection);
    const auto cropped = camera_of_cube(open_cube(folder / "b.hdr")->info(), "");
    EXPECT_EQ(cropped->pixel_weight(2, 3), wide_camera().pixel_weight(9, 14));
  }
}

/// Others' cubes may call something else a camera: what it says is not ours to understand.
TEST(CameraGeometry, ForeignCamerasStayAsTheyAre) {
  const TemporaryFolder folder;
  Cube cube = make_cube(4, 3, equal_bands(400, 500, 1));
  cube.info.metadata[kCameraKey] = "Specim FX10";
  for (const char* name : {"a.exr", "a.hdr"}) {
    write_cube_file(cube, folder / name);
    CubeSelection selection;
    convert_cube(folder / name, folder / "b.hdr", selection);
    selection.crop = PixelRect{1, 1, 2, 2};
    convert_cube(folder / name, folder / "c.hdr", selection);
    for (const char* converted : {"b.hdr", "c.hdr"})
      EXPECT_EQ(read_cube(folder / converted).info.metadata.at(kCameraKey), "Specim FX10");
  }
}

TEST(PixelMask, GrowsBySquares) {
  PixelMask mask(6, 5);
  mask.insert(1, 1);
  mask.insert(5, 4);
  const PixelMask grown = mask.grown(1);
  EXPECT_EQ(grown.count(), 9u + 4u);
  EXPECT_TRUE(grown.at(0, 0) && grown.at(2, 2) && grown.at(4, 3));
  EXPECT_FALSE(grown.at(3, 3));
  EXPECT_EQ(mask.grown(4000000000u).count(), 30u);
  EXPECT_EQ(mask.grown(0).count(), 2u);
  const PixelMask ring = grown.without(mask);
  EXPECT_EQ(ring.count(), 11u);
  EXPECT_FALSE(ring.at(1, 1));
  EXPECT_EQ(mask.rows().begin, 1u);
  EXPECT_EQ(mask.rows().end, 5u);
  EXPECT_EQ(PixelMask(3, 3).rows().end, 0u);
  EXPECT_EQ(PixelMask::of_ids(2, 1, {-1, 3}, {3}).count(), 1u);
  EXPECT_EQ(PixelMask::of_rectangle(6, 5, {4, 0, 2, 3}).count(), 6u);
}

/// Ids are whole numbers of 32 bits. 5e9 without the bits above them would be 705032704.
/// Every pixel against the definition; a square as large as the image in no more time than a small one.
TEST(PixelMask, GrowsByAnyNumberOfPixels) {
  std::mt19937 random(9);
  for (const uint32_t reach : {0u, 1u, 2u, 5u, 40u}) {
    PixelMask mask(23, 17);
    for (int i = 0; i < 4; ++i) mask.insert(random() % 23, random() % 17);
    const PixelMask grown = mask.grown(reach);
    for (uint32_t y = 0; y < 17; ++y)
      for (uint32_t x = 0; x < 23; ++x) {
        bool near = false;
        for (uint32_t v = y - std::min(y, reach); v <= std::min(16u, y + reach); ++v)
          for (uint32_t u = x - std::min(x, reach); u <= std::min(22u, x + reach); ++u)
            near = near || mask.at(u, v);
        ASSERT_EQ(grown.at(x, y), near) << x << " " << y << " " << reach;
      }
  }
  const PixelMask full = PixelMask::of_rectangle(4096, 1024, {0, 0, 4096, 1024});
  EXPECT_EQ(full.grown(65535).count(), full.count());
}

TEST(PixelMask, WhatIsNoIdIsOfNoObject) {
  const float none = std::numeric_limits<float>::quiet_NaN(), infinite = INFINITY;
  const std::vector<float> plane{3,    3.5f, 5e9f,          infinite, -infinite,
                                 none, -1,   4294967296.0f, -0.0f,    4294967040.0f};
  const PixelMask mask = PixelMask::of_ids(10, 1, plane, {0, 3, 705032704, 2147483648u, 4294967040u});
  for (uint32_t x = 0; x < 10; ++x) EXPECT_EQ(mask.at(x, 0), x == 0 || x >= 8) << plane[x];
}

/// sum n (f - mean)^2 / (N (R - 1)) by hand: values 1, 2, 6 with 1, 2, 1 samples: mean 2.75, squares
/// 1.75^2 + 2 0.75^2 + 3.25^2 = 14.75, over 4 * 2.
TEST(Replicates, ErrorByHand) {
  const std::vector<double> values{1, 2, 6}, samples{1, 2, 1};
  EXPECT_NEAR(replicate_error(values, samples), std::sqrt(14.75 / 8), 1e-15);
  EXPECT_TRUE(std::isnan(replicate_error(std::vector<double>{1}, std::vector<double>{1})));
  // What has no value is left out, with its samples.
  const std::vector<double> gaps{1, std::nan(""), 2, 6}, all{1, 9, 2, 1};
  EXPECT_EQ(replicate_error(gaps, all), replicate_error(values, samples));
  EXPECT_EQ(count_values(gaps), 3u);
}

/// A cube of 4 x 2 pixels in two channels, its object in the two pixels of the left column, and two
/// replicates around it.
class Signatures : public testing::Test {
 protected:
  static constexpr double kArea = 0.5;

  std::filesystem::path write(const char* name, float object, float around, float spread,
                              int replicates = 2) {
    Cube cube = make_cube(4, 2, equal_bands(400, 500, 2));
    cube.info.samples_per_pixel = 8;
    cube.info.replicates = static_cast<uint32_t>(replicates);
    cube.info.metadata = {{kCameraKey, "orthographic pixel_area 0.5"}, {"seed", "1"}};
    fill(cube, object, around, 0);
    write_cube_file(cube, folder / name, 2);
    for (int r = 0; r < replicates; ++r) {
      Cube one = cube;
      one.info.metadata["replicate"] = std::to_string(r);
      fill(one, object, around, r % 2 == 0 ? spread : -spread);
      write_cube_file(one, folder / (std::string(1, name[0]) + ".r0" + std::to_string(r) + ".hdr"), 2);
    }
    return folder / name;
  }
  /// The second channel is twice the first; a replicate adds `shift` to the object, half of it around it.
  static void fill(Cube& cube, float object, float around, float shift) {
    for (std::size_t p = 0; p < 8; ++p)
      for (std::size_t k = 0; k < 2; ++k)
        cube.mean[2 * p + k] = (p % 4 == 0 ? object + shift : around + shift / 2) * static_cast<float>(k + 1);
  }
  static SignatureMask left_column(bool ring) {
    SignatureMask mask{"left", PixelMask::of_rectangle(4, 2, {0, 0, 1, 2}), std::nullopt};
    if (ring) mask.surroundings = mask.pixels.grown(1).without(mask.pixels);
    return mask;
  }
  Signature measured(const std::filesystem::path& file, bool ring, ReplicatedCube* background = nullptr) {
    ReplicatedCube cube = open_replicated_cube(file);
    const auto camera = camera_of_cube(cube.mean->info(), "");
    return measure_signatures(cube, background, {left_column(ring)}, *camera).front();
  }
  TemporaryFolder folder;
};

TEST_F(Signatures, FiguresAndErrorsByHand) {
  const Signature s = measured(write("a.hdr", 8, 2, 0.5f), true);
  EXPECT_EQ(s.pixels, 2u);
  EXPECT_EQ(s.area_m2, 2 * kArea);
  ASSERT_EQ(s.bands.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    const BandSignature& band = s.bands[static_cast<std::size_t>(k)];
    const double f = k + 1;
    EXPECT_NEAR(band.radiance.value, 8 * f, 1e-6);
    EXPECT_NEAR(band.intensity.value, 8 * f, 1e-6);
    EXPECT_NEAR(band.background.value, 2 * f, 1e-6);
    EXPECT_NEAR(band.contrast_intensity.value, 6 * f, 1e-6);
    EXPECT_NEAR(band.contrast.value, 3, 1e-6);
    // Two replicates at +-d have the error d: 0.5 for the object, 0.25 around it, so 0.25 for the difference
    // and (0.5 - 4 * 0.25) / 2 for the contrast.
    EXPECT_NEAR(band.radiance.error, 0.5 * f, 1e-6);
    EXPECT_NEAR(band.intensity.error, 0.5 * f, 1e-6);
    EXPECT_NEAR(band.background.error, 0.25 * f, 1e-6);
    EXPECT_NEAR(band.contrast_intensity.error, 0.25 * f, 1e-6);
    EXPECT_NEAR(band.contrast.error, 0.25, 1e-6);
  }
}

TEST_F(Signatures, BackgroundCubesArePaired) {
  const auto file = write("a.hdr", 8, 2, 0.5f);
  ReplicatedCube same = open_replicated_cube(write("b.hdr", 3, 3, 0.5f));
  const BandSignature band = measured(file, false, &same).bands[0];
  EXPECT_NEAR(band.contrast_intensity.value, 5, 1e-6);
  EXPECT_NEAR(band.contrast_intensity.error, 0, 1e-6) << "the noise is common";
  ReplicatedCube more = open_replicated_cube(write("c.hdr", 3, 3, 0.5f, 4));
  const BandSignature unpaired = measured(file, false, &more).bands[0];
  EXPECT_NEAR(unpaired.radiance.error, 0.5, 1e-6);
  EXPECT_TRUE(std::isnan(unpaired.contrast.error));
  EXPECT_TRUE(std::isnan(unpaired.background.error));
  ReplicatedCube other;
  Cube wrong = make_cube(4, 2, equal_bands(400, 600, 2));
  write_cube_file(wrong, folder / "w.hdr", 2);
  other.mean = open_cube(folder / "w.hdr");
  EXPECT_EQ(error_of([&] { measured(file, false, &other); }),
            "background: must have the size and the channels of the cube");
  Cube narrow = make_cube(4, 2, equal_bands(400, 500, 2));
  narrow.info.metadata = {{kCameraKey, "orthographic pixel_area 0.25"}};
  write_cube_file(narrow, folder / "n.hdr", 2);
  other.mean = open_cube(folder / "n.hdr");
  EXPECT_EQ(
      error_of([&] { measured(file, false, &other); }),
      "background: has another camera (orthographic pixel_area 0.25) than the cube (orthographic pixel_area 0.5)");
}

/// The background's errors are by its own samples: at +-d of 30 and 10 the mean is d / 2 off the middle, error^2 = (30 / 4 + 10 * 9 / 4) d^2 / 40.
TEST_F(Signatures, BackgroundsHaveSamplesOfTheirOwn) {
  const auto file = write("a.hdr", 8, 2, 0.5f);
  ReplicatedCube behind = open_replicated_cube(write("b.hdr", 3, 3, 0.5f));
  behind.samples = {30, 10};
  const BandSignature band = measured(file, false, &behind).bands[0];
  EXPECT_NEAR(band.radiance.error, 0.5, 1e-6);
  EXPECT_NEAR(band.background.error, 0.5 * std::sqrt(0.75), 1e-6);
  behind.samples = {30, 0};
  EXPECT_TRUE(std::isnan(measured(file, false, &behind).bands[0].background.error))
      << "one replicate has no spread";
  EXPECT_TRUE(std::isnan(measured(file, false, &behind).bands[0].contrast.error));
}

TEST_F(Signatures, WithoutABackgroundAllReplicatesCount) {
  const Signature s = measured(write("a.hdr", 8, 2, 0.5f), false);
  EXPECT_FALSE(s.has_background);
  EXPECT_EQ(s.replicates, 2u);
}

TEST_F(Signatures, DistanceTurnsSolidAnglesIntoAreas) {
  Cube cube = make_cube(4, 2, equal_bands(400, 500, 1));
  std::fill(cube.mean.begin(), cube.mean.end(), 3.0f);
  write_cube_file(cube, folder / "a.hdr", 2);
  ReplicatedCube one = open_replicated_cube(folder / "a.hdr");
  CameraGeometry camera{false, 0, 4, 2, 0, 0, 0.01, 0, 0};
  SignatureMask mask = left_column(false);
  mask.distance_m = 100;
  const Signature s = measure_signatures(one, nullptr, {mask}, camera).front();
  const double solid_angle = camera.pixel_weight(0, 0) + camera.pixel_weight(0, 1);
  EXPECT_NEAR(s.area_m2, 1e4 * solid_angle, 1e-12);
  EXPECT_NEAR(s.bands[0].intensity.value, 3e4 * solid_angle, 1e-9);
  EXPECT_TRUE(std::isnan(s.bands[0].intensity.error));
  EXPECT_FALSE(s.has_background);
}

TEST_F(Signatures, Tables) {
  ReplicatedCube cube = open_replicated_cube(write("a.hdr", 8, 2, 0.5f));
  const auto camera = camera_of_cube(cube.mean->info(), "");
  const auto table = [&](bool ring, bool errors) {
    write_signatures(cube.mean->info(), measure_signatures(cube, nullptr, {left_column(ring)}, *camera),
                     errors, folder / "t.csv");
    return read_file(folder / "t.csv");
  };
  EXPECT_EQ(table(false, false),
            "mask,pixels,distance_m,area_m2,channel,min_nm,max_nm,radiance,intensity\n"
            "left,2,,1,425nm,400,450,8,8\nleft,2,,1,475nm,450,500,16,16\n");
  EXPECT_EQ(
      table(true, true),
      "mask,pixels,distance_m,area_m2,channel,min_nm,max_nm,radiance,radiance_error,intensity,"
      "intensity_error,background,background_error,contrast_intensity,contrast_intensity_error,contrast,"
      "contrast_error\n"
      "left,2,,1,425nm,400,450,8,0.5,8,0.5,2,0.25,6,0.25,3,0.25\n"
      "left,2,,1,475nm,450,500,16,1,16,1,4,0.5,12,0.5,3,0.25\n");
}

TEST_F(Signatures, ReplicatesMustBeThoseOfTheCube) {
  const auto file = write("a.hdr", 8, 2, 0.5f);
  const auto error = [&] { return error_of(folder, [&] { open_replicated_cube(file); }); };
  EXPECT_EQ(error(), "accepted");
  write("b.hdr", 9, 2, 0.5f);  // the scene was changed, the replicates are those of before
  for (const char* end : {".hdr", ".img"})
    std::filesystem::copy_file(folder / (std::string("b") + end), folder / (std::string("a") + end),
                               std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(
      error(),
      "a.r00.hdr ...: the replicates' mean is not this cube's (of another render, or of an interrupted one?): move them elsewhere");
  write("a.hdr", 8, 2, 0.5f);
  std::filesystem::copy_file(folder / "a.r00.hdr", folder / "a.r01.hdr",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(error(), "a.r01.hdr: is no replicate of this cube (of another render?): remove it");
  std::filesystem::remove(folder / "a.r01.hdr");
  EXPECT_EQ(error(), "a.r01.hdr: is missing: the cube has 2 replicates");
  std::filesystem::remove(folder / "a.r00.hdr");
  EXPECT_FALSE(open_replicated_cube(file).has_errors());
}

/// Sums of channels and regions have the errors that the replicates give,
/// though channels and pixels move together.
/// What strips of a conversion hold: the sum and its variance, and of every file all bands.
TEST_F(Signatures, MemoryIsThatOfAllFilesRead) {
  const auto file = write("a.hdr", 8, 2, 0.5f, 4);
  CubeSelection selection;
  selection.rebin = ChannelList{{400, 500, ""}};
  const auto one = select_from_cube(open_cube(file), selection);
  EXPECT_EQ(one->floats_held(), 1u + 2u);
  const auto all = with_replicate_variance(select_from_cube(open_replicated_cube(file), selection));
  EXPECT_EQ(all->floats_held(), 2u + (1 + 4) * (1u + 2u));
}

/// An interrupted render: the last replicate has the left half alone, where the image is four times brighter. Errors of
/// regions are those of the replicates that have all of it.
TEST_F(Signatures, ErrorsComeFromReplicatesThatHaveTheWholeRegion) {
  const auto file = write("a.hdr", 8, 2, 0.5f, 3);
  Cube last = read_cube(folder / "a.r02.hdr");
  for (std::size_t p = 0; p < 8; ++p)
    for (std::size_t k = 0; k < 2; ++k)
      if (p % 4 >= 2) last.mean[2 * p + k] = std::nanf("");
  write_cube_file(last, folder / "a.r02.hdr", 2);
  ReplicatedCube cube = open_replicated_cube(file);
  const auto table = [&](const PixelRect& region) {
    Messages messages;
    write_csv(cube, folder / "t.csv", {region}, messages.sink());
    return std::pair{read_file(folder / "t.csv"), messages.texts};
  };
  // Sums over the row are 14 and 28, the first two replicates' off by 0.5 + 3 * 0.25 and its double.
  const auto [whole, said] = table({0, 0, 4, 1});
  EXPECT_EQ(whole,
            "channel,min_nm,max_nm,value,standard_error\n425nm,400,450,3.5,0.3125\n475nm,450,500,7,0.625\n");
  EXPECT_EQ(
      said,
      std::vector<std::string>{
          "region 0,0,4,1: standard errors come from 2 of 3 replicates: the others do not have all its pixels"});
  EXPECT_EQ(table({0, 0, 2, 2}).second, std::vector<std::string>{});
}

/// A mean over the pixels that have values is not that of the region: it is said how many lack them.
TEST_F(Signatures, PixelsWithoutValuesAreCounted) {
  Cube cube = make_cube(4, 2, equal_bands(400, 500, 2));
  fill(cube, 8, 2, 0);
  for (std::size_t k = 0; k < 2; ++k) cube.mean[2 * 3 + k] = std::nanf("");
  write_cube_file(cube, folder / "a.hdr", 2);
  Messages messages;
  write_csv(*open_cube(folder / "a.hdr"), folder / "t.csv", {{0, 0, 4, 1}}, messages.sink());
  EXPECT_EQ(messages.texts,
            std::vector<std::string>{"region 0,0,4,1: 1 of 4 pixels have no value and are left out"});
}

TEST_F(Signatures, ReplicatesGiveErrorsToSumsAndRegions) {
  const auto file = write("a.hdr", 8, 2, 0.5f);
  CubeSelection selection;
  selection.rebin = ChannelList{{400, 500, ""}};
  convert_cube(file, folder / "s.hdr", selection);
  const Cube sum = read_cube(folder / "s.hdr");
  ASSERT_TRUE(sum.info.variance);
  EXPECT_NEAR(sum.mean[0], 24, 1e-5);
  EXPECT_NEAR(sum.variance[0], 1.5 * 1.5, 1e-5);
  ReplicatedCube cube = open_replicated_cube(file);
  write_csv(cube, folder / "t.csv", {{0, 0, 1, 2}});
  EXPECT_EQ(read_file(folder / "t.csv"),
            "channel,min_nm,max_nm,value,standard_error\n425nm,400,450,8,0.5\n475nm,450,500,16,1\n");
}

}  // namespace
}  // namespace kiloband
