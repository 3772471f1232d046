// The device's angle of a direction against the C library's in double.
#include <numbers>

#include "support.hpp"

namespace kiloband::test::angle_test {
namespace {

OpenclProbe& probe() {
  static OpenclProbe instance(std::string("#include \"base/scene.clh\"\n#include \"base/angle.clh\"\n") +
                              kProbeHead + R"(
__kernel void angle(ARGS) {
  ITEM
  out->f[0] = arc_tangent(in->f[0], in->f[1]);
}
)");
  return instance;
}

std::vector<float> angles(const std::vector<ItemIn>& in) {
  std::vector<float> all;
  for (const ItemOut& out : run_items(probe(), "angle", FlatScene{}, in)) all.push_back(out.f[0]);
  return all;
}

TEST(GpuAngle, IsThatOfTheLibraryAllAround) {
  Random random(3);
  std::vector<ItemIn> in;
  for (int i = 0; i < 100000; ++i) {
    const double phi = 2 * std::numbers::pi * i / 100000, size = std::exp2(random.between(-30, 30));
    in.push_back({{static_cast<float>(size * std::sin(phi)), static_cast<float>(size * std::cos(phi))}, {}});
  }
  const std::vector<float> found = angles(in);
  for (std::size_t i = 0; i < in.size(); ++i)
    ASSERT_NEAR(found[i], std::atan2(double{in[i].f[0]}, double{in[i].f[1]}), 4e-7) << i;
}

/// Near the axis: beams are narrow, and the poles of a map have rows.
TEST(GpuAngle, SmallOnesHaveAllTheirDigits) {
  std::vector<ItemIn> in;
  for (int i = 0; i < 10000; ++i) in.push_back({{std::exp2(-i * 0.012f), 1}, {}});
  const std::vector<float> found = angles(in);
  for (std::size_t i = 0; i < in.size(); ++i)
    ASSERT_LT(std::fabs(found[i] / std::atan2(double{in[i].f[0]}, 1.0) - 1), 3e-7) << i;
}

TEST(GpuAngle, AxesAndTheOrigin) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const std::vector<float> found = angles({{{0, 1}, {}},
                                           {{0, -1}, {}},
                                           {{-0.0f, -1}, {}},
                                           {{1, 0}, {}},
                                           {{-1, 0}, {}},
                                           {{0, 0}, {}},
                                           {{1e-30f, -1e30f}, {}},
                                           {{-2, 2}, {}}});
  EXPECT_EQ(found, (std::vector<float>{0, kPi, -kPi, kPi / 2, -kPi / 2, 0, kPi, -kPi / 4}));
}

}  // namespace
}  // namespace kiloband::test::angle_test
