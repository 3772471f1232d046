// Derived channels: sensor responses that are accumulated beside the rendered channels,
// with errors of their own.
#pragma once

#include <string>
#include <vector>

#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Row d weights channel values: response_d(lambda_k) share_k. Channels that cover a wavelength share it, so that overlaps do not count twice;
/// each as densely as its lambda_k fall there (balance heuristic), share_k = (1 / width_k) / sum_j 1 / width_j over the channels j with
/// min_j <= lambda_k < max_j. With equal shares a wide channel, which hardly ever looks at a narrow response, would have
/// half of it, and be all of its noise.
struct DerivedChannels {
  std::vector<std::string> names;
  std::vector<RegularTable> responses;
  ChannelList bands = {};  // what the outputs state of each, with its name: effective_band() of the response
};

}  // namespace kiloband
