// Progress of a run of cases on standard error: a line that is overwritten on a terminal, a line for every case elsewhere.
#pragma once

#include <string>

namespace kiloband {

class RunProgress {
 public:
  /// enabled false: silent (--quiet)
  explicit RunProgress(bool enabled);
  void begin(const std::string& name);
  /// fraction: of the whole run
  void update(double fraction);
  /// Ends the line.
  void end() const;

 private:
  bool enabled_, terminal_;
  double fraction_ = 0;
  std::string name_;
};

}  // namespace kiloband
