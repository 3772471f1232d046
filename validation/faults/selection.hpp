// Which fault the process has. Only in builds with KILOBAND_FAULTS.
#pragma once

#include <string>

namespace kiloband::faults {

/// "cpu:NAME", "opencl:NAME" or "shared:NAME" of the table, or "none". At the start it is what the
/// environment variable KILOBAND_FAULT says, none without it; a wrong one ends the process.
///
/// Backends that exist already may keep what they have: select first, then read the scene and make the
/// backend. Not while something renders.
///
/// throws std::invalid_argument  no such fault, or not there
void select_fault(const std::string& text);

/// What select_fault() would take for it.
std::string selected_fault();

/// Has a fault while it lives, and what was selected before afterwards.
class FaultScope {
 public:
  explicit FaultScope(const std::string& text) : before_(selected_fault()) { select_fault(text); }
  ~FaultScope() { select_fault(before_); }
  FaultScope(const FaultScope&) = delete;
  FaultScope& operator=(const FaultScope&) = delete;

 private:
  std::string before_;
};

}  // namespace kiloband::faults
