// How library code reports what is not an error: it never prints.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/error.hpp"

namespace kiloband {

enum class Severity { kNote, kWarning };

/// One message for the user. position.file is empty where no file is concerned.
struct Diagnostic {
  Severity severity = Severity::kWarning;
  SourcePosition position;
  std::string message;

  /// "file:line:column: warning: message", or "warning: message" without a position.
  std::string to_string() const;
};

/// Receives diagnostics; an empty function drops them.
using DiagnosticSink = std::function<void(const Diagnostic&)>;

inline void warn(const DiagnosticSink& sink, SourcePosition position, std::string message) {
  if (sink) sink({Severity::kWarning, std::move(position), std::move(message)});
}
inline void note(const DiagnosticSink& sink, SourcePosition position, std::string message) {
  if (sink) sink({Severity::kNote, std::move(position), std::move(message)});
}

}  // namespace kiloband
