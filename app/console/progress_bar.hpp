// Progress on standard error: a bar on a terminal, a line now and then elsewhere.
#pragma once

#include <chrono>
#include <string>

#include "render/session.hpp"

namespace kiloband {

class ProgressBar {
 public:
  /// enabled false: silent (--quiet)
  explicit ProgressBar(bool enabled);
  void update(const Progress& progress);
  /// Ends the bar's line.
  void finish(const Progress& last);

 private:
  void print(const Progress& progress) const;

  bool enabled_, terminal_;
  std::chrono::steady_clock::time_point last_print_;
  double interval_seconds_;
  Progress last_;
};

/// "38 %  1.20 Mpaths/s  12 s left  worst channel's error 0.8 %"
std::string describe(const Progress& progress);

}  // namespace kiloband
