#include "viewer/display/brightness.hpp"

#include <algorithm>
#include <cmath>

#include "spectral/planck.hpp"

namespace kiloband::viewer {
namespace {

/// In Wien's limit ln L is a straight line over 1 / T, in the limit of Rayleigh and Jeans over ln T: between neighbours of equal ratio
/// a straight line over 1 / T is right to about (ratio - 1)^2 / 8 of T.
constexpr std::size_t kNodes = 1024;

double node_temperature(std::size_t i) {
  const double part = static_cast<double>(i) / (kNodes - 1);
  return BrightnessTemperature::kLeastK *
         std::pow(BrightnessTemperature::kMostK / BrightnessTemperature::kLeastK, part);
}

}  // namespace

BrightnessTemperature::BrightnessTemperature(const Channel& channel) {
  for (std::size_t i = 0; i < kNodes; ++i)
    log_radiance_.push_back(std::log(planck_integral(channel.min_nm, channel.max_nm, node_temperature(i))));
}

double BrightnessTemperature::operator()(double radiance) const {
  if (std::isnan(radiance)) return radiance;
  if (radiance <= 0) return 0;
  const double wanted = std::log(radiance);
  const auto above = std::ranges::upper_bound(log_radiance_, wanted);
  if (above == log_radiance_.end()) return kMostK;
  const auto i = static_cast<std::size_t>(above - log_radiance_.begin());
  if (i == 0) return kLeastK;
  const double low = log_radiance_[i - 1], high = log_radiance_[i];
  if (std::isinf(low)) return node_temperature(i);  // Planck's law is below the least double there
  const double t = (wanted - low) / (high - low);
  return 1 / ((1 - t) / node_temperature(i - 1) + t / node_temperature(i));
}

}  // namespace kiloband::viewer
