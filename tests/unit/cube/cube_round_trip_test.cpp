// What is written comes back: bit for bit where the quantity does not change, rounded once where it does.
#include <gtest/gtest.h>

#include <cmath>

#include "cube_support.hpp"

namespace kiloband {
namespace {

using namespace test;

void expect_same_info(const CubeInfo& read, const CubeInfo& written) {
  EXPECT_EQ(read.width, written.width);
  EXPECT_EQ(read.height, written.height);
  EXPECT_EQ(read.variance, written.variance);
  EXPECT_EQ(read.quantity, written.quantity);
  EXPECT_EQ(read.samples_per_pixel, written.samples_per_pixel);
  EXPECT_EQ(read.replicates, written.replicates);
  EXPECT_EQ(read.replicate_samples, written.replicate_samples);
  EXPECT_EQ(read.aux, written.aux);
  EXPECT_EQ(read.metadata, written.metadata);
  ASSERT_EQ(read.bands.size(), written.bands.size());
  for (std::size_t k = 0; k < read.bands.size(); ++k) {
    EXPECT_EQ(read.bands[k].channel.min_nm, written.bands[k].channel.min_nm) << k;
    EXPECT_EQ(read.bands[k].channel.max_nm, written.bands[k].channel.max_nm) << k;
    EXPECT_EQ(read.bands[k].channel.name, written.bands[k].channel.name) << k;
    EXPECT_EQ(read.bands[k].derived, written.bands[k].derived) << k;
  }
}

void expect_round_trip(Cube cube, const std::string& extension, uint32_t strip = 32) {
  cube.info.quantity = Quantity::kIntegral;
  const TemporaryFolder folder;
  const auto file = folder / ("cube" + extension);
  write_cube_file(cube, file, strip);
  const Cube read = read_cube(file);
  expect_same_info(read.info, cube.info);
  EXPECT_EQ(count_differences(read.mean, cube.mean), 0u);
  EXPECT_EQ(count_differences(read.variance, cube.variance), 0u);
  EXPECT_EQ(count_differences(read.aux, cube.aux), 0u);
}

/// Out of order, with gaps, overlaps, equal centres, names, derived bands, 0.1 nm and thermal channels.
std::vector<Band> awkward_bands() {
  return {{{700, 710, ""}, false},
          {{400, 410, ""}, false},
          {{402, 408, ""}, false},
          {{404.9, 405.1, ""}, false},
          {{405.5, 409.25, "blue, 'x'"}, false},
          {{0, 0, "cam era.R{1}"}, true},
          {{8000, 12000, ""}, false},
          {{400, 410, ""}, false},
          {{380 + 1 / 3.0, 390, "50 %"}, false},
          {{390, 830, "Y"}, true}};
}

class RoundTrip : public testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, OneBand) {
  expect_round_trip(make_cube(5, 3, equal_bands(380, 780, 1)), GetParam());
}

TEST_P(RoundTrip, SevenBandsOverSeveralTiles) {
  expect_round_trip(make_cube(70, 67, equal_bands(380, 780, 7)), GetParam());
  expect_round_trip(make_cube(70, 67, equal_bands(380, 780, 7)), GetParam(), 64);
  expect_round_trip(make_cube(70, 67, equal_bands(380, 780, 7)), GetParam(), 67);
}

TEST_P(RoundTrip, ThousandBands) {
  expect_round_trip(make_cube(33, 34, equal_bands(380, 2500, 1000)), GetParam());
}

TEST_P(RoundTrip, Everything) {
  Cube cube = make_cube(37, 41, awkward_bands(), true, {"depth.Z", "normal.X", "normal.Y", "a,b {c}"});
  cube.info.samples_per_pixel = 1ull << 40;
  cube.info.replicates = 16;
  cube.info.replicate_samples = {1ull << 40, 7, 0, 7, 7, 7, 7, 7, 7, 7};
  cube.info.metadata = {{"seed", "7"},
                        {"scene", "a = {b}; 100 % \xC3\xA4"},
                        {"lines", "two\nlines"},
                        {"Samples", "not the width"},
                        {"channels", "x"},
                        {"meta.seed", "8"},
                        {" blank ", ""},
                        {"; comment", "y"},
                        {"S0.550nm", "looks like a channel"}};
  expect_round_trip(cube, GetParam());
}

TEST_P(RoundTrip, SpecialNumbersAreWrittenAsTheyAre) {
  Cube cube = make_cube(4, 1, equal_bands(400, 420, 2), true);
  cube.mean = {NAN, INFINITY, -INFINITY, -0.0f, 1e-45f, 3.4e38f, 0, -1};
  cube.variance = cube.mean;
  expect_round_trip(cube, GetParam());
}

TEST_P(RoundTrip, DensityIsTheQuotientRoundedOnce) {
  Cube cube = make_cube(9, 5, awkward_bands(), true);
  cube.info.quantity = Quantity::kDensity;
  const TemporaryFolder folder;
  const auto file = folder / (std::string("cube") + GetParam());
  write_cube_file(cube, file);
  const Cube read = read_cube(file);
  EXPECT_EQ(read.info.quantity, Quantity::kDensity);
  for (std::size_t i = 0; i < cube.mean.size(); ++i) {
    const Band& band = cube.info.bands[i % cube.info.bands.size()];
    const double width = band.derived ? 1 : band.channel.max_nm - band.channel.min_nm;
    EXPECT_EQ(read.mean[i], static_cast<float>(cube.mean[i] / width));
    EXPECT_EQ(read.variance[i], static_cast<float>(cube.variance[i] / (width * width)));
  }
}

TEST_P(RoundTrip, AnyRowsInAnyOrder) {
  const Cube cube = make_cube(40, 70, equal_bands(400, 500, 3), true, {"depth.Z"});
  const TemporaryFolder folder;
  const auto file = folder / (std::string("cube") + GetParam());
  Cube integral = cube;
  integral.info.quantity = Quantity::kIntegral;
  write_cube_file(integral, file);
  const auto reader = open_cube(file);
  for (const auto& [y0, rows] : {std::pair{69u, 1u}, {30u, 5u}, {0u, 70u}, {31u, 1u}, {5u, 0u}}) {
    const CubeRows part = rows_of(cube, y0, rows);
    std::vector<float> mean(part.mean.size()), aux(part.aux.size());
    reader->read_rows(y0, rows, mean, {});
    reader->read_aux(y0, rows, aux);
    EXPECT_EQ(count_differences(mean, {part.mean.begin(), part.mean.end()}), 0u) << y0;
    EXPECT_EQ(count_differences(aux, {part.aux.begin(), part.aux.end()}), 0u) << y0;
  }
}

/// Of renders that were interrupted: what was expected is in the header already when rows are written.
TEST_P(RoundTrip, CountsBecomeSmallerAfterTheRows) {
  Cube cube = make_cube(4, 32, equal_bands(400, 500, 3));
  cube.info.quantity = Quantity::kIntegral;
  cube.info.metadata = {{"seed", "7"}};
  const TemporaryFolder folder;
  const auto file = folder / (std::string("cube") + GetParam());
  const auto writer = create_cube_writer(file, cube.info, 32);
  writer->set_counts({1024, 16, {64, 64, 64}});
  writer->write_rows(rows_of(cube, 0, 32));
  writer->set_counts({0, 2, {64, 3, 0}});
  writer->finish();
  const Cube read = read_cube(file);
  cube.info.replicates = 2;
  cube.info.replicate_samples = {64, 3, 0};
  expect_same_info(read.info, cube.info);
  EXPECT_EQ(count_differences(read.mean, cube.mean), 0u);
}

TEST_P(RoundTrip, MisuseIsALogicError) {
  const Cube cube = make_cube(4, 64, equal_bands(400, 500, 3));
  const TemporaryFolder folder;
  const auto file = folder / (std::string("cube") + GetParam());
  EXPECT_THROW(create_cube_writer(file, cube.info, 33), std::logic_error);
  EXPECT_THROW(create_cube_writer(file, cube.info, 0), std::logic_error);
  const auto writer = create_cube_writer(file, cube.info, 32);
  EXPECT_THROW(writer->write_rows(rows_of(cube, 32, 32)), std::logic_error);
  EXPECT_THROW(writer->write_rows(rows_of(cube, 0, 16)), std::logic_error);
  writer->write_rows(rows_of(cube, 0, 32));
  EXPECT_THROW(writer->finish(), std::logic_error);
  writer->write_rows(rows_of(cube, 32, 32));
  EXPECT_THROW(writer->write_rows(rows_of(cube, 32, 32)), std::logic_error);
  writer->finish();
  EXPECT_THROW(writer->finish(), std::logic_error);
  const auto reader = open_cube(file);
  std::vector<float> buffer(4 * 3);
  EXPECT_THROW(reader->read_rows(64, 1, buffer, {}), std::logic_error);
  EXPECT_THROW(reader->read_rows(0, 2, buffer, {}), std::logic_error);
  EXPECT_THROW(reader->read_rows(0, 1, buffer, buffer), std::logic_error);  // there are no variances
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, testing::Values(".exr", ".hdr"),
                         [](const auto& format) { return std::string(format.param + 1); });

TEST(CubeMemory, AFewRowsOfManyBandsAreReadAlone) {
  // 64 GB of ENVI data in a sparse file: reading a row touches 4 KiB per band, not the file.
  const TemporaryFolder folder;
  folder.write(
      "big.hdr",
      "ENVI\nsamples = 1000\nlines = 16000\nbands = 1000\ndata type = 4\ninterleave = bsq\nbyte order = 0\n");
  folder.write("big.img", "");
  std::filesystem::resize_file(folder / "big.img", 64'000'000'000);
  const auto reader = open_cube(folder / "big.hdr");
  std::vector<float> row(1000 * 1000, 1.0f);
  reader->read_rows(15999, 1, row, {});
  EXPECT_EQ(std::count(row.begin(), row.end(), 0.0f), 1000 * 1000);
}

}  // namespace
}  // namespace kiloband
