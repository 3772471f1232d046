// Resampling in vectors against RegularTable, bit by bit.
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
      const DoubleTable view{table.values.data(), size, table.min_nm, table.step_nm, extrapolate};
      const EvaluatorKernels& kernels = evaluator_kernels(GetParam());
      kernels.sample_exact(view, lambda_nm.data(), nullptr, lambda_nm.size(), plain.data());
      kernels.sample_exact(view, lambda_nm.data(), factor.data(), lambda_nm.size(), scaled.data());
      for (std::size_t i = 0; i < lambda_nm.size(); ++i) {
        const double value = table(lambda_nm[i]);
        EXPECT_EQ(plain[i], static_cast<float>(value)) << lambda_nm[i] << " nm, " << size << " entries";
        EXPECT_EQ(scaled[i], static_cast<float>(value * factor[i])) << lambda_nm[i] << " nm";
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::test_tables
