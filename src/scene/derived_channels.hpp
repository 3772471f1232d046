// Derived channels: sensor responses that are accumulated beside the rendered channels, with errors of their
// own.
#pragma once

#include <string>
#include <vector>

#include "spectral/spectrum.hpp"

namespace kiloband {

/// Row d weights channel values: response_d(lambda_k) / number of channels that cover lambda_k, so that
/// overlapping channels do not count twice.
struct DerivedChannels {
  std::vector<std::string> names;
  std::vector<RegularTable> responses;
};

}  // namespace kiloband
