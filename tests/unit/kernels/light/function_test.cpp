// The device's functions and divisions against the C library's in double: what every other tolerance here stands on.
#include <fmt/format.h>

#include <functional>
#include <numbers>

#include "support.hpp"

namespace kiloband::test::function_test {
namespace {

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n") + kProbeHead + R"(
__kernel void functions(ARGS) {
  ITEM
  out->f[0] = sin(in->f[0]);
  out->f[1] = cos(in->f[0]);
  out->f[2] = exp(in->f[1]);
  out->f[3] = expm1(in->f[1]);
  out->f[4] = exp2(in->f[1]);
  out->f[5] = log(in->f[2]);
  out->f[6] = erf(in->f[3]);
  out->f[7] = sqrt(in->f[2]);
  out->f[8] = in->f[2] / in->f[3];
}
)");
  return instance;
}

/// A function of the kernels: what it is of an item's inputs, and how many units of the last place OpenCL lets
/// it be off (1.2, table 7.1, full profile).
struct Function {
  const char* name;
  std::function<double(const ItemIn&)> exact;
  double most_units;
};

std::vector<Function> functions() {
  const bool rounds = probe().rounds_correctly();
  return {{"sin", [](const ItemIn& in) { return std::sin(double{in.f[0]}); }, 4},
          {"cos", [](const ItemIn& in) { return std::cos(double{in.f[0]}); }, 4},
          {"exp", [](const ItemIn& in) { return std::exp(double{in.f[1]}); }, 3},
          {"expm1", [](const ItemIn& in) { return std::expm1(double{in.f[1]}); }, 3},
          {"exp2", [](const ItemIn& in) { return std::exp2(double{in.f[1]}); }, 3},
          {"log", [](const ItemIn& in) { return std::log(double{in.f[2]}); }, 3},
          {"erf", [](const ItemIn& in) { return std::erf(double{in.f[3]}); }, 16},
          {"sqrt", [](const ItemIn& in) { return std::sqrt(double{in.f[2]}); }, rounds ? 0.5 : 3},
          {"divide", [](const ItemIn& in) { return double{in.f[2]} / double{in.f[3]}; }, rounds ? 0.5 : 2.5}};
}

/// Distance in units of the last place of the float next to `exact`.
double units(float found, double exact) {
  int exponent = 0;
  std::frexp(exact, &exponent);
  return std::fabs(found - exact) / std::ldexp(1.0, exponent - 24);
}

/// Angles of two turns both ways, exponents from -60 to 60, quotients within 2^40.
TEST(GpuFunctions, AreWithinTheBoundsOfOpencl) {
  Random random(31);
  std::vector<ItemIn> in(200000);
  for (ItemIn& item : in) {
    const double sign = random.index(2) == 0 ? 1 : -1;
    item = {{random.between(-12.6, 12.6), random.between(-60, 60), std::exp2(random.between(-20, 20)),
             static_cast<float>(sign * std::exp2(random.between(-20, 2)))},
            {}};
  }
  const std::vector<ItemOut> out = run_items(probe(), "functions", FlatScene{}, in);
  std::string text;
  const std::vector<Function> all = functions();
  for (std::size_t k = 0; k < all.size(); ++k) {
    double worst = 0;
    for (std::size_t i = 0; i < in.size(); ++i)
      worst = std::fmax(worst, units(out[i].f[k], all[k].exact(in[i])));
    EXPECT_LE(worst, all[k].most_units * (1 + 1e-9)) << all[k].name;
    text += fmt::format(" {} {:.2f}", all[k].name, worst);
  }
  RecordProperty("units_of_the_last_place",
                 text);  // of this device, in what the program writes with --gtest_output
}

}  // namespace
}  // namespace kiloband::test::function_test
