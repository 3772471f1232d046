#include "base/diagnostics.hpp"

namespace kiloband {

std::string Diagnostic::to_string() const {
  const std::string label = severity == Severity::kWarning ? "warning: " : "note: ";
  return position.file.empty() ? label + message : position.to_string() + ": " + label + message;
}

}  // namespace kiloband
