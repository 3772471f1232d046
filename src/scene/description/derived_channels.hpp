// Derived channels: sensor responses that are accumulated beside the rendered channels,
// with errors of their own.
#pragma once

#include <string>
#include <vector>

#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Row d weights channel values: response_d(lambda_k) / number of channels that cover lambda_k, so that
/// overlapping channels do not count twice.
struct DerivedChannels {
  std::vector<std::string> names;
  std::vector<RegularTable> responses;
  ChannelList bands = {};  // what the outputs state of each, with its name: effective_band() of the response
};

}  // namespace kiloband
