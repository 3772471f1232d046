// Brightness temperature: of the blackbody that has a channel's radiance.
#pragma once

#include <vector>

#include "spectral/channels.hpp"

namespace kiloband::viewer {

/// Inverts Planck's law, integrated over one channel.
class BrightnessTemperature {
 public:
  static constexpr double kLeastK = 20, kMostK = 20000;

  /// channel: 0 < min_nm < max_nm
  explicit BrightnessTemperature(const Channel& channel);

  /// radiance  the channel's integral, W m^-2 sr^-1
  /// returns   K, to 1e-4 of it from kLeastK to kMostK (less what single precision of the radiance costs), these where
  ///           it is beyond; 0 for a radiance of 0 and below, NaN for NaN
  double operator()(double radiance) const;

 private:
  std::vector<double>
      log_radiance_;  // ascending, at equal steps of 1 / T; -infinity where there is none in double
};

}  // namespace kiloband::viewer
