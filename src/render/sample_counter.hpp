// What the files of a render state of its samples, counted in the film: an interrupted render has fewer than were wanted.
#pragma once

#include "cube/cube_io.hpp"
#include "film/spectral_film.hpp"

namespace kiloband {

/// The least over pixels of everything: error bars get no degrees of freedom that one of them does not have.
/// Replicates count where a pixel has two or more (others have no variance), samples of a replicate where it has any.
class SampleCounter {
 public:
  /// kept  whether the replicates' cubes are written
  SampleCounter(uint32_t replicates, bool kept);

  void add(const SpectralFilm& film);
  /// Pixels that were never reached.
  void add_missing();
  SampleCounts counts() const;
  /// What counts() of a render that is not interrupted is at most.
  SampleCounts expected(uint64_t samples_per_pixel) const;

 private:
  uint64_t samples_;
  uint32_t replicates_, fewest_;
  std::vector<uint64_t> of_replicates_;  // empty: not kept
};

}  // namespace kiloband
