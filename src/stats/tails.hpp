// How much of an image's noise a few replicates carry: fireflies are reported, not hidden.
#pragma once

#include <cstddef>
#include <vector>

#include "stats/comparison/replicate_image.hpp"

namespace kiloband::stats {

/// Of one side and channel. Deviations are those of a pixel's replicate means from their median.
struct TailWeight {
  std::size_t count = 0;    // replicate means (pixels times replicates)
  double effective = 0;     // (sum d^2)^2 / sum d^4: how many of them carry the variance; count / 3 if normal
  double top_variance = 0;  // largest d^2 / sum d^2
  double top_sum = 0;       // largest d / sum of the means: what one replicate mean adds to the image
  double hill_index = 0;    // tail index of d from the largest 0.1 % (at least 20); 2 or less: no finite
                            // variance in sight. NaN with fewer than 200 values or where hardly any varies
};

class Tails {
 public:
  explicit Tails(std::size_t channels);
  void add(const UnitSample& pixel);
  /// [channel]
  std::vector<TailWeight> finish() const;

 private:
  struct Channel {
    std::size_t count = 0;
    double sum = 0, squares = 0, fourths = 0;
    std::vector<double> largest;  // a heap whose front is the smallest
  };
  std::vector<Channel> channels_;
};

/// The channel with the smallest effective share.
std::size_t heaviest_channel(const std::vector<TailWeight>& tails);

}  // namespace kiloband::stats
