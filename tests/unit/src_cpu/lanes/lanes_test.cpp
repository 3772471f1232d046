// The value types of src_cpu/lanes: every instruction set gives the bits of one lane, and what one lane gives is right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "lane_functions.hpp"
#include "shared/sampler.h"
#include "shared/sobol_table.h"
#include "shared/warp.h"

namespace kiloband::test {
namespace {

constexpr std::size_t kCount = 1 << 14;

using Arrays = std::vector<std::vector<float>>;

const NamedFunction& find(const std::vector<NamedFunction>& functions, const std::string& name) {
  return *std::ranges::find(functions, name, &NamedFunction::name);
}

Arrays apply(const NamedFunction& function, const Arrays& in) {
  Arrays out(function.outputs, std::vector<float>(in[0].size(), 0.0f));
  std::vector<const float*> from;
  std::vector<float*> to;
  for (const auto& array : in) from.push_back(array.data());
  for (auto& array : out) to.push_back(array.data());
  function.apply(from.data(), to.data(), in[0].size());
  return out;
}

Arrays apply_one_lane(const std::string& name, const Arrays& in) {
  return apply(find(functions_of_one_lane(), name), in);
}

std::vector<float> random_bits(uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> values(kCount);
  for (float& value : values) value = kb_as_f32(static_cast<kb_u32>(random()));
  return values;
}

std::vector<float> random_between(uint32_t seed, double low, double high) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> numbers(low, high);
  std::vector<float> values(kCount);
  for (float& value : values) value = static_cast<float>(numbers(random));
  return values;
}

std::vector<float> random_units(uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> values(kCount);
  for (float& value : values) value = kb_unit_float(static_cast<kb_u32>(random()));
  return values;
}

/// Zeros, ones, the ends of ranges, infinities, NaN, in front of what else there is.
std::vector<float> with_special(std::vector<float> values, std::size_t shift) {
  const float special[] = {
      0.0f,   -0.0f, 1.0f,     -1.0f,     0.5f, 0.25f, 0.75f, 4.0f,      88.1f,   -87.4f,
      1e-30f, 3e38f, INFINITY, -INFINITY, NAN,  1e-7f, 1e6f,  0.999999f, 0.1249f, KB_ONE_MINUS_EPSILON};
  for (std::size_t i = 0; i < std::size(special) * std::size(special); ++i)
    values[i] = special[(shift ? i / std::size(special) : i) % std::size(special)];
  return values;
}

/// The bits, with one NaN for all.
uint32_t bits_of(float value) {
  return std::isnan(value) ? 0x7fc00000u : kb_as_u32(value);
}

/// Numbers that the function is made for: conversions to whole numbers need those below 2^31.
Arrays inputs_of(const std::string& name) {
  if (name == "arithmetic") {
    Arrays in{with_special(random_between(1, -1e6, 1e6), 0), with_special(random_between(2, -1e6, 1e6), 1)};
    for (auto& array : in)
      for (float& value : array)
        if (!(std::fabs(value) < 1e9f)) value = 3.25f;  // floor() is for such
    return in;
  }
  if (name == "words" || name == "philox" || name == "sobol" || name == "sampler_keys" || name == "move" ||
      name == "records")
    return {random_bits(3), random_bits(4)};
  if (name == "exp") return {with_special(random_between(5, -100, 89), 0)};
  if (name == "erf_inverse") return {random_between(6, -1, 1)};
  if (name == "erf") return {random_between(7, 0, 5)};
  if (name == "log") return {random_between(8, 1e-30, 50)};
  if (name == "arc_tangent" || name == "normalize" || name == "doubles")
    return {random_between(9, -2, 2), random_between(10, -2, 2)};
  return {random_units(11), random_units(12)};
}

class Lanes : public testing::TestWithParam<cpu::Isa> {};

TEST_P(Lanes, GiveTheBitsOfOneLane) {
  if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no " << to_string(GetParam());
  for (const NamedFunction& function : functions_of(GetParam())) {
    const Arrays in = inputs_of(function.name);
    const Arrays one = apply_one_lane(function.name, in), many = apply(function, in);
    for (uint32_t k = 0; k < function.outputs; ++k) {
      std::size_t differ = 0;
      for (std::size_t i = 0; i < in[0].size(); ++i) {
        if (bits_of(one[k][i]) == bits_of(many[k][i])) continue;
        if (++differ == 1)
          ADD_FAILURE() << function.name << " output " << k << " of " << in[0][i] << ", "
                        << (in.size() > 1 ? in[1][i] : 0) << ": " << many[k][i] << " instead of "
                        << one[k][i];
      }
      EXPECT_EQ(differ, 0u) << function.name << " output " << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, Lanes,
                         testing::Values(cpu::Isa::kSse4, cpu::Isa::kAvx2, cpu::Isa::kAvx512),
                         [](const auto& set) { return std::string(to_string(set.param)); });

/// The largest error over the inputs, relative or absolute.
double largest_error(const std::vector<float>& values, const std::vector<float>& in, bool relative,
                     const std::function<double(double)>& truth) {
  double largest = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double right = truth(in[i]), error = std::abs(values[i] - right);
    largest = std::max(largest, relative ? error / std::abs(right) : error);
  }
  return largest;
}

TEST(LaneMath, ErrorsAreThoseStated) {
  const std::vector<float> exponents = random_between(21, -87, 88), positive = random_between(22, 1e-6, 4);
  EXPECT_LT(largest_error(apply_one_lane("exp", {exponents})[0], exponents, true,
                          [](double x) { return std::exp(x); }),
            1.5e-7);
  std::vector<float> logarithms = random_between(23, -30, 30);
  for (float& x : logarithms) x = std::exp(x);
  EXPECT_LT(largest_error(apply_one_lane("log", {logarithms})[0], logarithms, true,
                          [](double x) { return std::log(x); }),
            2e-7);
  EXPECT_LT(largest_error(apply_one_lane("erf", {positive})[0], positive, true,
                          [](double x) { return std::erf(x); }),
            3e-7);
  const std::vector<float> turns = random_between(24, 0, 2);
  const Arrays sine_cosine = apply_one_lane("turns", {turns});
  const double two_pi = 2 * std::numbers::pi;
  EXPECT_LT(largest_error(sine_cosine[0], turns, false, [&](double x) { return std::sin(two_pi * x); }),
            3e-7);
  EXPECT_LT(largest_error(sine_cosine[1], turns, false, [&](double x) { return std::cos(two_pi * x); }),
            3e-7);
}

TEST(LaneMath, SmallExponentialsAreDenormals) {
  const std::vector<float> exponents = random_between(29, -110, -88);
  const std::vector<float> values = apply_one_lane("exp", {exponents})[0];
  EXPECT_LT(largest_error(values, exponents, false, [](double x) { return std::exp(x); }),
            1.5 * double(std::numeric_limits<float>::denorm_min()));
  for (std::size_t i = 0; i < kCount; ++i) {
    if (exponents[i] < -104) {
      ASSERT_EQ(values[i], 0.0f) << exponents[i];
    }
    if (exponents[i] > -103) {
      ASSERT_GT(values[i], 0.0f) << exponents[i];
    }
  }
}

TEST(LaneMath, NearOneTheLogarithmKeepsItsDigits) {
  std::vector<float> near_one = random_between(25, 0.9, 1.1);
  EXPECT_LT(largest_error(apply_one_lane("log", {near_one})[0], near_one, false,
                          [](double x) { return std::log(x); }),
            1.5e-8);
}

TEST(LaneMath, TheInverseErrorFunctionInvertsIt) {
  const std::vector<float> x = random_between(26, -0.99999, 0.99999);
  const std::vector<float> inverse = apply_one_lane("erf_inverse", {x})[0];
  double largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    // d erf = 2 / sqrt(pi) exp(-y^2) dy: the error in y.
    const double y = inverse[i], slope = 2 / std::sqrt(std::numbers::pi) * std::exp(-y * y);
    largest = std::max(largest, std::abs(std::erf(y) - x[i]) / slope / std::max(std::abs(y), 1e-3));
  }
  EXPECT_LT(largest, 1e-6);
}

/// Near the axes angles are as exact as their size asks: poles of maps, and the beams of narrow spots.
TEST(LaneMath, SmallAnglesKeepTheirDigits) {
  std::vector<float> y = random_between(39, 1e-6, 1e-2), x = random_between(40, 0.5, 2);
  const std::vector<float> angle = apply_one_lane("arc_tangent", {y, x})[0];
  for (std::size_t i = 0; i < kCount; ++i) {
    const double right = std::atan2(double(y[i]), double(x[i]));
    ASSERT_LT(std::abs(angle[i] - right), 2e-7 * right) << y[i] << " " << x[i];
  }
}

TEST(LaneMath, AnglesLieInTheRightQuadrant) {
  const std::vector<float> y = random_between(27, -2, 2), x = random_between(28, -2, 2);
  const std::vector<float> angle = apply_one_lane("arc_tangent", {y, x})[0];
  double largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    largest = std::max(largest, std::abs(angle[i] - std::atan2(double(y[i]), double(x[i]))));
  EXPECT_LT(largest, 4e-7);
  const std::vector<float> on_axes =
      apply_one_lane("arc_tangent", {{0, 1, 0, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                     {1, 0, -1, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}})[0];
  EXPECT_EQ(on_axes[0], 0.0f);
  EXPECT_EQ(on_axes[1], 0.5f * KB_PI);
  EXPECT_EQ(on_axes[2], KB_PI);
  EXPECT_EQ(on_axes[3], -0.5f * KB_PI);
  EXPECT_EQ(on_axes[4], 0.0f);
}

TEST(LaneSampler, RandomNumbersAreThoseOfTheSharedSampler) {
  const std::vector<float> a = random_bits(31), b = random_bits(32);
  const Arrays philox = apply_one_lane("philox", {a, b}), sobol = apply_one_lane("sobol", {a, b});
  for (std::size_t i = 0; i < kCount; ++i) {
    const kb_u32 first = kb_as_u32(a[i]), second = kb_as_u32(b[i]);
    KbSamplerKey key{};
    key.seed = 0x123456789abcdefull;
    key.sampler = KB_SAMPLER_INDEPENDENT;
    key.pixel = first;
    key.sample = second;
    const KbFloat4 u = kb_sampler_block(&key, 7);
    ASSERT_TRUE(u.x == philox[0][i] && u.y == philox[1][i] && u.z == philox[2][i] && u.w == philox[3][i])
        << i;
    key.sampler = KB_SAMPLER_SOBOL;
    key.table = kb_sobol_table;
    key.reversed_index = first;
    key.key0 = second;
    key.key1 = second ^ 0x9e3779b9u;
    const KbFloat4 s = kb_sampler_block(&key, 5);
    ASSERT_TRUE(s.x == sobol[0][i] && s.y == sobol[1][i] && s.z == sobol[2][i] && s.w == sobol[3][i]) << i;
  }
}

TEST(LaneSampler, KeysAreThoseOfTheSharedSampler) {
  const std::vector<float> pixels = random_bits(41);
  const Arrays keys = apply_one_lane("sampler_keys", {pixels});
  for (std::size_t i = 0; i < kCount; ++i) {
    const KbSamplerKey key =
        kb_sampler_key(KB_SAMPLER_SOBOL, 0xfedcba9876543210ull, kb_sampler_root(0xfedcba9876543210ull),
                       kb_as_u32(pixels[i]), 5, 3, 11, kb_sobol_table);
    const kb_u32 expected[] = {key.pixel, key.sample, key.reversed_index, key.key0, key.key1};
    for (std::size_t k = 0; k < 5; ++k) ASSERT_EQ(kb_as_u32(keys[k][i]), expected[k]) << k << " " << i;
  }
}

TEST(LaneSampler, MapsAreThoseOfTheSharedOnes) {
  const std::vector<float> u = random_units(33), v = random_units(34);
  const Arrays hemisphere = apply_one_lane("cosine_hemisphere", {u, v});
  const Arrays sphere = apply_one_lane("uniform_sphere", {u, v});
  const Arrays triangle = apply_one_lane("uniform_triangle", {u, v});
  for (std::size_t i = 0; i < kCount; ++i) {
    const KbFloat2 disk = kb_disk_concentric(u[i], v[i]);
    ASSERT_NEAR(hemisphere[0][i], disk.x, 3e-7) << i;
    ASSERT_NEAR(hemisphere[1][i], disk.y, 3e-7) << i;
    ASSERT_NEAR(std::hypot(hemisphere[0][i], hemisphere[1][i], hemisphere[2][i]), 1, 4e-7) << i;
    const KbFloat3 w = kb_sphere_uniform(u[i], v[i]);
    ASSERT_NEAR(sphere[0][i], w.x, 5e-7) << i;
    ASSERT_NEAR(sphere[1][i], w.y, 5e-7) << i;
    ASSERT_EQ(sphere[2][i], w.z) << i;
    const KbFloat2 b = kb_triangle_uniform(u[i], v[i]);
    ASSERT_TRUE(triangle[0][i] == b.x && triangle[1][i] == b.y) << i;
  }
}

TEST(Lanes, ChosenOnesStandTogether) {
  const std::vector<float> x = random_units(35), below = random_units(36);
  const Arrays chosen = apply_one_lane("choose", {x, below});
  std::vector<float> expected;
  for (std::size_t i = 0; i < kCount; ++i)
    if (x[i] < below[i]) expected.push_back(x[i]);
  ASSERT_GT(expected.size(), kCount / 3);
  expected.resize(kCount);
  EXPECT_EQ(chosen[0], expected);
  EXPECT_EQ(chosen[1], expected) << "the places where they stood";
}

TEST(Lanes, DoublesKeepWhatFloatsLose) {
  const std::vector<float> x = random_between(37, -2, 2), y = random_between(38, -2, 2);
  const Arrays result = apply_one_lane("doubles", {x, y});
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(result[0][i], static_cast<float>(double{x[i]} * y[i] - double{y[i]} * y[i])) << i;
    ASSERT_EQ(result[1][i], static_cast<float>(std::sqrt(double{x[i]} * x[i] + double{y[i]} * y[i]))) << i;
    const double third = x[i] / 3.0, product = third * y[i];
    ASSERT_EQ(result[2][i], static_cast<float>(third - std::floor(third))) << i;
    ASSERT_EQ(result[3][i], std::fabs(product) < 0.5 ? static_cast<float>(product) : 0.0f) << i;
    ASSERT_EQ(result[4][i], static_cast<float>(std::fmin(third, double{y[i]}) - third)) << i;
    ASSERT_EQ(result[5][i], static_cast<float>(std::fmax(third, double{y[i]}) - third)) << i;
  }
}

}  // namespace
}  // namespace kiloband::test
