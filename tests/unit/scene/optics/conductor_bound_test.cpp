// The bound of a metal's reflectance against Fresnel's formula in complex numbers.
#include "scene/optics/conductor_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace kiloband {
namespace {

/// Unpolarised reflectance in the textbook form.
double reflectance(double cosine, double n, double k) {
  const std::complex<double> eta(n, k);
  const std::complex<double> cos_t = std::sqrt(1.0 - (1 - cosine * cosine) / (eta * eta));
  const std::complex<double> s = (cosine - eta * cos_t) / (cosine + eta * cos_t);
  const std::complex<double> p = (eta * cosine - cos_t) / (eta * cosine + cos_t);
  return 0.5 * (std::norm(s) + std::norm(p));
}

RegularTable table(std::vector<double> values) {
  return {380, 140, std::move(values), true, 0};
}

const ChannelList kChannels = {{400, 450, ""}, {600, 700, ""}}, kGuide = {{500, 520, ""}, {690, 800, ""}};
const std::vector<double> kGoldN = {1.6, 1.1, 0.2, 0.15}, kGoldK = {1.9, 1.8, 3.3, 4.9};

/// At and between the nodes nothing is above the bound, for any wavelength of channels and guide bands, and what is
/// largest is below it by no more than the slack and the slope of F in a cell.
TEST(ConductorBound, IsAboveTheReflectanceAndNear) {
  const RegularTable n = table(kGoldN), k = table(kGoldK);
  const std::vector<float> bound = make_conductor_bound(n, k, {&kChannels, &kGuide});
  ASSERT_EQ(bound.size(), KB_CONDUCTOR_CELLS + 1u);
  for (int i = 0; i <= 1000; ++i) {
    const double cosine = i / 1000.0, at = kb_conductor_bound(bound.data(), static_cast<float>(cosine));
    double largest = 0;
    for (const ChannelList* list : {&kChannels, &kGuide})
      for (const Channel& c : *list)
        for (int j = 0; j <= 20; ++j) {
          const double lambda_nm = c.min_nm + c.width_nm() * j / 20;
          largest = std::max(largest, reflectance(cosine, n(lambda_nm), k(lambda_nm)));
        }
    ASSERT_LE(largest, at + 1e-7) << cosine;
    ASSERT_GE(largest, at - (cosine < 0.05 ? 0.1 : 0.01)) << cosine;
  }
}

/// A channel that is not in any list does not count.
TEST(ConductorBound, IsOfTheChannelsGiven) {
  const ChannelList blue = {{400, 410, ""}};
  const std::vector<float> bound = make_conductor_bound(table(kGoldN), table(kGoldK), {&blue});
  double largest = 0;
  for (const double lambda_nm : {400.0, 405.0, 410.0})
    largest = std::max(largest, reflectance(1, table(kGoldN)(lambda_nm), table(kGoldK)(lambda_nm)));
  EXPECT_NEAR(bound.back(), 1.002 * largest, 1e-6);
}

/// An index of 0 reflects everything, at grazing incidence too, where the formula is 0 / 0.
TEST(ConductorBound, OfNoIndexIsOne) {
  const std::vector<float> bound =
      make_conductor_bound(table({0, 0, 0, 0}), table({0, 0, 0, 0}), {&kChannels, &kGuide});
  EXPECT_EQ(bound, std::vector<float>(KB_CONDUCTOR_CELLS + 1, 1.0f));
}

}  // namespace
}  // namespace kiloband
