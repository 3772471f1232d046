// Saves an unfinished render now and then, and does not let it fail for that.
#pragma once

#include <chrono>
#include <set>
#include <string>

#include "base/diagnostics.hpp"
#include "film/spectral_film.hpp"
#include "render/session.hpp"

namespace kiloband {

/// A checkpoint that cannot be written is a warning, once for each reason; the next one is tried an interval
/// later. What stood there stays.
class CheckpointKeeper {
 public:
  /// settings.checkpoint is set; settings must outlive the object.
  explicit CheckpointKeeper(const SessionSettings& settings) : settings_(settings) {}

  /// The time to the next checkpoint begins anew.
  void restart() { last_ = Clock::now(); }
  /// The film's samples are those of the checkpoint: it was read.
  void resumed() { stands_ = true; }
  /// Writes a checkpoint if an interval has passed.
  void save_if_due(const SpectralFilm& film);
  /// Writes the last one.
  void save_last(const SpectralFilm& film);

 private:
  using Clock = std::chrono::steady_clock;

  /// Returns what is the matter; empty: it is written.
  std::string save(const SpectralFilm& film);

  const SessionSettings& settings_;
  Clock::time_point last_ = Clock::now();
  bool stands_ = false;  // there is a checkpoint of this render
  std::set<std::string> told_;
};

}  // namespace kiloband
