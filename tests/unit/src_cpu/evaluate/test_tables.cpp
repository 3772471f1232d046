// Resampling in vectors against RegularTable, bit by bit; lookups of colours against double precision.
#include <cmath>
#include <limits>
#include <random>

#include "random_scene.hpp"
#include "src_cpu/evaluate/evaluator_kernels.hpp"

namespace kiloband::test::test_tables {
namespace {

class Tables : public EachIsa {};
INSTANTIATE_TEST_SUITE_P(, Tables, testing::ValuesIn(available_isas()), isa_name);

/// Inside, at entries, at both ends, a hair and far beyond them, and no number at all.
std::vector<double> wavelengths_nm(const RegularTable& table) {
  const double last = table.min_nm + table.step_nm * static_cast<double>(table.values.size() - 1);
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> all{table.min_nm,
                          last,
                          last * (1 + 1e-15),
                          last * (1 + 1e-13),
                          std::nextafter(last, infinity),
                          last * 1.001,
                          table.min_nm * (1 - 1e-15),
                          0,
                          -5,
                          1e300,
                          infinity,
                          std::nan("")};
  for (std::size_t i = 0; i < table.values.size(); ++i)
    all.push_back(table.min_nm + table.step_nm * static_cast<double>(i));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(table.min_nm - 20, last + 20);
  while (all.size() % kMaxLanes != 0 || all.size() < 200) all.push_back(uniform(random));
  return all;
}

TEST_P(Tables, ExactSamplesHaveTheBitsOfRegularTable) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.01, 2);
  for (const std::size_t size : {2u, 3u, 61u}) {
    for (const bool extrapolate : {false, true}) {
      RegularTable table;
      table.min_nm = 380.7;
      table.step_nm = 20.0 / 3;
      table.extrapolate = extrapolate;
      while (table.values.size() < size) table.values.push_back(uniform(random));
      const std::vector<double> lambda_nm = wavelengths_nm(table);
      std::vector<double> factor(lambda_nm.size());
      for (double& f : factor) f = uniform(random);
      std::vector<float> plain(lambda_nm.size()), scaled(lambda_nm.size());
      std::vector<double> doubles(lambda_nm.size());
      const DoubleTable view{table.values.data(), size, table.min_nm, table.step_nm, extrapolate};
      const EvaluatorKernels& kernels = evaluator_kernels(GetParam());
      kernels.sample_exact(view, lambda_nm.data(), nullptr, lambda_nm.size(), plain.data());
      kernels.sample_exact(view, lambda_nm.data(), factor.data(), lambda_nm.size(), scaled.data());
      kernels.sample_double(view, lambda_nm.data(), lambda_nm.size(), doubles.data());
      for (std::size_t i = 0; i < lambda_nm.size(); ++i) {
        const double value = table(lambda_nm[i]);
        EXPECT_EQ(doubles[i], value) << lambda_nm[i] << " nm, " << size << " entries";
        EXPECT_EQ(plain[i], static_cast<float>(value)) << lambda_nm[i] << " nm, " << size << " entries";
        EXPECT_EQ(scaled[i], static_cast<float>(value * factor[i])) << lambda_nm[i] << " nm";
      }
    }
  }
}

struct Sigmoid {
  double value, tail;  // tail: what is left to 1, if that is less
};

Sigmoid sigmoid(double v) {
  const double r = std::sqrt(1 + v * v), tail = 0.5 / (r * (r + std::abs(v)));
  return {v < 0 ? tail : 1 - tail, tail};
}

/// Parabolas whose values at the offsets are up to `size` (and a hundred times less).
ColourTerms random_terms(uint32_t count, float size, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(-1, 1), weight(0.1f, 2);
  ColourTerms terms;
  terms.count = count;
  for (uint32_t i = 0; i < count; ++i) {
    const float of_term = size * std::pow(10.0f, uniform(random) - 1);
    terms.coefficients[i][0] = of_term * uniform(random) * 1e-5f;
    terms.coefficients[i][1] = of_term * uniform(random) * 1e-3f;
    terms.coefficients[i][2] = of_term * uniform(random);
    terms.weights[i] = weight(random);
  }
  return terms;
}

double parabola(const float (&c)[3], float y) {
  return std::fma(std::fma(c[0], y, c[1]), y, c[2]);
}

TEST_P(Tables, ColoursAreAccurateUpToTheSmallestOfSigmoids) {
  constexpr double kSmallest = 0.5 / 0x1p31;
  const EvaluatorKernels& kernels = evaluator_kernels(GetParam());
  std::mt19937 random(3);
  std::vector<float> offsets(kMaxLanes), row(kMaxLanes);
  for (std::size_t k = 0; k < kMaxLanes; ++k) offsets[k] = -235 + 30 * static_cast<float>(k);
  for (const uint32_t count : {0u, 2u, 4u}) {
    for (const float size : {1.0f, 10.0f, 1e3f, 1e6f, 1e18f, 1e30f}) {
      for (int repetition = 0; repetition < 50; ++repetition) {
        ColourTerms terms = random_terms(count, size, random);
        kernels.colour_row(terms, {offsets.data(), kMaxLanes}, kMaxLanes, row.data());
        for (std::size_t k = 0; k < kMaxLanes; ++k) {
          double sum = 0, error = 1e-12;
          for (uint32_t i = 0; i < count; ++i) {
            const double v = parabola(terms.coefficients[i], offsets[k]);
            const Sigmoid s = sigmoid(v);
            sum += terms.weights[i] * s.value;
            // Of v: two roundings of terms that may cancel.
            const double of_v = 1.2e-7 * (std::abs(terms.coefficients[i][2]) + std::abs(v));
            error += terms.weights[i] *
                     (2 * s.tail * of_v / std::sqrt(1 + v * v) + kSmallest * (s.tail < kSmallest));
          }
          EXPECT_NEAR(row[k], sum, error + 6e-7 * sum) << count << " terms of up to " << size;
        }
      }
    }
  }
}

TEST_P(Tables, ColoursTakeFactorsInPlace) {
  const EvaluatorKernels& kernels = evaluator_kernels(GetParam());
  std::mt19937 random(4);
  ColourTerms terms = random_terms(4, 3, random);
  terms.constant = 0.25f;
  std::vector<float> offsets(kMaxLanes), plain(kMaxLanes), row(kMaxLanes);
  for (std::size_t k = 0; k < kMaxLanes; ++k)
    offsets[k] = 20 * static_cast<float>(k), row[k] = 1 + offsets[k];
  const std::vector<float> factor = row;
  kernels.colour_row(terms, {offsets.data(), kMaxLanes}, kMaxLanes, plain.data());
  terms.factor = row.data();
  kernels.colour_row(terms, {offsets.data(), kMaxLanes}, kMaxLanes, row.data());
  for (std::size_t k = 0; k < kMaxLanes; ++k) EXPECT_EQ(row[k], plain[k] * factor[k]);
}

/// Beyond the visible, channels have what is computed once for them, with their bits.
TEST_P(Tables, ColoursBeyondTheVisibleAreThoseOfItsEnd) {
  const EvaluatorKernels& kernels = evaluator_kernels(GetParam());
  std::mt19937 random(7);
  ColourTerms terms = random_terms(4, 3, random);
  terms.constant = 0.25f;
  constexpr std::size_t kCount = 4 * kMaxLanes;
  std::vector<float> offsets(kCount), factor(kCount);
  for (std::size_t k = 0; k < kCount; ++k) factor[k] = 1 + static_cast<float>(k);
  terms.factor = factor.data();
  for (std::size_t distinct = 0; distinct <= kCount; ++distinct) {
    for (std::size_t k = 0; k < kCount; ++k) offsets[k] = 3 * static_cast<float>(std::min(k, distinct)) - 100;
    std::vector<float> each(kCount), row(kCount);
    kernels.colour_row(terms, {offsets.data(), kCount}, kCount, each.data());
    kernels.colour_row(terms, {offsets.data(), distinct}, kCount, row.data());
    EXPECT_EQ(row, each) << distinct << " wavelengths";
  }
}

TEST_P(Tables, AColourThatIsNoNumberStaysOne) {
  std::mt19937 random(6);
  for (uint32_t i = 0; i < 4; ++i) {
    ColourTerms terms = random_terms(4, 1, random);
    terms.coefficients[i][2] = std::numeric_limits<float>::quiet_NaN();
    std::vector<float> offsets(kMaxLanes), row(kMaxLanes);
    evaluator_kernels(GetParam()).colour_row(terms, {offsets.data(), kMaxLanes}, kMaxLanes, row.data());
    for (const float value : row) EXPECT_TRUE(std::isnan(value));
  }
}

}  // namespace
}  // namespace kiloband::test::test_tables
