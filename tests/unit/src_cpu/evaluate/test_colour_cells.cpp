// Colours at many narrow channels: interpolated in cells of wavelengths, against double precision.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <span>

#include "random_scene.hpp"
#include "spectral/colour/rgb.hpp"
#include "src_cpu/evaluate/dense_spectra.hpp"
#include "src_cpu/evaluate/texture/colour_cells.hpp"

namespace kiloband::test::test_colour_cells {
namespace {

class ColourCellRow : public EachIsa {};
INSTANTIATE_TEST_SUITE_P(, ColourCellRow, testing::ValuesIn(available_isas()), isa_name);

/// Rows of lookups at the centres of channels.
struct Row {
  explicit Row(const ChannelList& list) : channels(list), cells(channels, pad_channels(channels.size())) {
    for (const Channel& c : channels)
      offsets.push_back(static_cast<float>(std::clamp(c.centre_nm(), 360.0, 830.0) - KB_TEXTURE_CENTRE_NM));
    offsets.resize(pad_channels(channels.size()), offsets.empty() ? 0 : offsets.back());
    placed = cells.place(offsets.data());
  }

  std::vector<float> values(const ColourTerms& terms, Isa isa, bool interpolated) const {
    std::vector<float> out(offsets.size());
    evaluator_kernels(isa).colour_row(terms,
                                      {offsets.data(), offsets.size(), interpolated ? placed : nullptr},
                                      channels.size(), out.data());
    out.resize(channels.size());
    return out;
  }

  ChannelList channels;
  ColourCellRows cells;
  std::vector<float> offsets;
  const ColourCells* placed;
};

ChannelList equal_channels(double from_nm, double to_nm, std::size_t count) {
  ChannelList list;
  const double step = (to_nm - from_nm) / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k)
    list.push_back(
        {from_nm + step * static_cast<double>(k), from_nm + step * static_cast<double>(k + 1), {}});
  return list;
}

using Colour = std::array<float, 3>;

/// A lookup in four texels of about one colour, as pictures have them.
ColourTerms around(const Colour& rgb, std::mt19937& random) {
  static const SigmoidTable sigmoids;
  std::uniform_real_distribution<float> nearby(0.9f, 1.1f), weight(0.05f, 1);
  ColourTerms terms;
  terms.count = 4;
  for (uint32_t i = 0; i < 4; ++i) {
    Colour texel = rgb;
    for (float& c : texel) c = std::clamp(c * nearby(random), 0.0f, 1.0f);
    std::ranges::copy(sigmoids(texel), terms.coefficients[i]);
    terms.weights[i] = weight(random);
  }
  return terms;
}

double in_double(const ColourTerms& terms, double y) {
  double sum = 0;
  for (uint32_t i = 0; i < terms.count; ++i) {
    const float(&c)[3] = terms.coefficients[i];
    const double v = (c[0] * y + c[1]) * y + c[2], r = std::sqrt(1 + v * v),
                 tail = 0.5 / (r * (r + std::abs(v)));
    sum += terms.weights[i] * (v < 0 ? tail : 1 - tail);
  }
  return sum;
}

/// What rounding v, of large terms that cancel, comes to in the sum.
double of_rounding(const ColourTerms& terms, double y) {
  double error = 0;
  for (uint32_t i = 0; i < terms.count; ++i) {
    const float(&c)[3] = terms.coefficients[i];
    const double v = (c[0] * y + c[1]) * y + c[2],
                 size = std::abs(c[0] * y * y) + std::abs(c[1] * y) + std::abs(c[2]);
    error += terms.weights[i] * 1.2e-7 * size * 0.5 / std::pow(1 + v * v, 1.5);
  }
  return error;
}

/// Values of rows against double precision, in units of what is allowed for those evaluated on their own, as test_tables.cpp has it, and
/// for the polynomial.
struct Accuracy {
  explicit Accuracy(double of_polynomial) : relative(6e-7 + of_polynomial) {}

  void add(const Row& row, const ColourTerms& terms, Isa isa) {
    const std::vector<float> values = row.values(terms, isa, true), alone = row.values(terms, isa, false);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double y = row.offsets[k], expected = in_double(terms, y);
      const double allowed = of_rounding(terms, y) + relative * expected + 1e-9;
      largest = std::max(largest, std::abs(values[k] - expected) / allowed);
      differ += values[k] != alone[k];
      ++all;
    }
  }

  double relative, largest = 0;
  std::size_t differ = 0, all = 0;
};

TEST_P(ColourCellRow, ColoursOfPicturesKeepTheirDigits) {
  std::mt19937 random(3);
  Accuracy accuracy(6e-7);
  constexpr float kLevels[] = {0, 0.02f, 0.2f, 0.5f, 0.9f, 1};
  for (const auto& [from, to] : {std::pair{380.0, 780.0}, {400.0, 700.0}, {300.0, 900.0}}) {
    const Row row(equal_channels(from, to, 1000));
    ASSERT_NE(row.placed, nullptr);
    for (const float r : kLevels)
      for (const float g : kLevels)
        for (const float b : kLevels) accuracy.add(row, around({r, g, b}, random), GetParam());
  }
  EXPECT_LE(accuracy.largest, 1);
  // Nearly half of all values, as two roundings of one number do: most are interpolated.
  EXPECT_GT(accuracy.differ, accuracy.all / 3);
}

/// Steps and bumps down to a fraction of the distance of nodes, which a polynomial does not have.
TEST_P(ColourCellRow, SteepColoursAreEvaluated) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> exponent(-6, 1), place(-215, 185), size(-20, 20), weight(0.05f, 1);
  const Row row(equal_channels(380, 780, 1000));
  Accuracy accuracy(1.6e-6);
  for (int repetition = 0; repetition < 2000; ++repetition) {
    ColourTerms terms;
    terms.count = 2;
    for (uint32_t i = 0; i < 2; ++i) {
      const float a = std::copysign(std::pow(10.0f, exponent(random)), size(random)), middle = place(random);
      const float coefficients[3] = {a, -2 * a * middle, a * middle * middle + size(random)};
      std::ranges::copy(coefficients, terms.coefficients[i]);
      terms.weights[i] = weight(random);
    }
    accuracy.add(row, terms, GetParam());
  }
  EXPECT_LE(accuracy.largest, 1);
  EXPECT_GT(accuracy.differ, accuracy.all / 20);
}

/// Alone, in order, in disorder, between wide ones and beyond the visible.
TEST_P(ColourCellRow, BitsOfAChannelAreItsOwn) {
  std::mt19937 random(5);
  ChannelList list = equal_channels(340, 880, 700);
  for (std::size_t k = 0; k < list.size(); k += 7) list[k].max_nm += 2;
  for (const bool shuffled : {false, true}) {
    if (shuffled) std::ranges::shuffle(list, random);
    const Row row(list);
    for (int repetition = 0; repetition < 20; ++repetition) {
      std::uniform_real_distribution<float> level(0, 1);
      const ColourTerms terms = around({level(random), level(random), level(random)}, random);
      const std::vector<float> values = row.values(terms, GetParam(), true);
      for (std::size_t k = 0; k < list.size(); k += 13)
        ASSERT_EQ(Row({list[k]}).values(terms, GetParam(), true)[0], values[k]) << list[k].min_nm;
    }
  }
}

TEST_P(ColourCellRow, AColourThatIsNoNumberStaysOne) {
  std::mt19937 random(6);
  const Row row(equal_channels(380, 780, 600));
  for (uint32_t i = 0; i < 4; ++i) {
    ColourTerms terms = around({0.5f, 0.3f, 0.2f}, random);
    terms.coefficients[i][1] = std::numeric_limits<float>::quiet_NaN();
    for (const float value : row.values(terms, GetParam(), true)) EXPECT_TRUE(std::isnan(value));
  }
}

TEST(ColourCellRows, WideChannelsAreAlone) {
  EXPECT_EQ(Row(equal_channels(380, 780, 100)).placed, nullptr);
  EXPECT_EQ(Row(equal_channels(3000, 5000, 500)).placed, nullptr);
  EXPECT_NE(Row(equal_channels(500, 501, 2)).placed, nullptr);
  EXPECT_EQ(Row({}).placed, nullptr);
  const Row rounded(equal_channels(380, 780, 500));  // 0.8 nm but for rounding: all or none
  ASSERT_NE(rounded.placed, nullptr);
  EXPECT_EQ(std::ranges::count(std::span(rounded.placed->cell, 500), ColourCells::kAlone), 0);
}

/// Rows of a whole list are those of its channels, at one offset and then at another.
void expect_own_bits(const ChannelList& list, Isa isa, std::mt19937& random) {
  const auto rows_of = [&](const ChannelList& channels) {
    auto scene = std::make_unique<FlatScene>();
    scene->channels = channels;
    scene->channel_scale.assign(channels.size(), 1.0);
    return scene;
  };
  const auto scene = rows_of(list);
  DenseSpectra all(*scene, evaluator_kernels(isa));
  for (const double mu : {0.25, 0.875}) {
    std::uniform_real_distribution<float> level(0, 1);
    const ColourTerms terms = around({level(random), level(random), level(random)}, random);
    const auto row_of = [&](DenseSpectra& spectra) {
      spectra.begin(mu, false);
      std::vector<float> row(spectra.padded_channels());
      evaluator_kernels(isa).colour_row(terms, spectra.texture_offsets(), spectra.channels(), row.data());
      return row;
    };
    const std::vector<float> values = row_of(all);
    for (std::size_t k = 0; k < list.size(); ++k) {
      const auto one = rows_of({list[k]});
      DenseSpectra alone(*one, evaluator_kernels(isa));
      ASSERT_EQ(row_of(alone)[0], values[k]) << list[k].min_nm;
    }
  }
}

/// Beyond 830 nm channels share a wavelength: narrow ones their polynomial, wide ones their value.
TEST_P(ColourCellRow, BitsOfAChannelAreItsOwnBeyondTheVisible) {
  std::mt19937 random(7);
  ChannelList narrow_first = equal_channels(800, 840, 100), wide_first = equal_channels(820, 900, 40);
  for (const Channel& c : equal_channels(840, 960, 60)) narrow_first.push_back(c);
  for (const Channel& c : equal_channels(900, 940, 100)) wide_first.push_back(c);
  for (int repetition = 0; repetition < 5; ++repetition) {
    expect_own_bits(narrow_first, GetParam(), random);
    expect_own_bits(wide_first, GetParam(), random);
    expect_own_bits(equal_channels(500, 530, 150), GetParam(), random);
    expect_own_bits({{504.4, 505.1, {}}, {600, 601.5, {}}}, GetParam(), random);  // from one cell to the next
  }
}

}  // namespace
}  // namespace kiloband::test::test_colour_cells
