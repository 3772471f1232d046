// What the code under test says: messages of its exceptions, diagnostics.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/diagnostics.hpp"
#include "base/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

/// The message of the Error that the action throws; "accepted" if it throws nothing.
template <class Error = InputError>
std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

/// The same of an InputError, without the folder in front of file names.
inline std::string error_of(const TemporaryFolder& folder, const std::function<void()>& action) {
  return folder.strip(error_of(action));
}

/// Keeps what is reported.
struct Messages {
  std::vector<std::string> texts;

  /// Takes messages alone, without "file:line: warning: ".
  DiagnosticSink sink() {
    return [this](const Diagnostic& d) { texts.push_back(d.message); };
  }
  /// Takes whole lines.
  DiagnosticSink lines() {
    return [this](const Diagnostic& d) { texts.push_back(d.to_string()); };
  }
  /// The same without the folder in front of file names.
  DiagnosticSink lines(const TemporaryFolder& folder) {
    return [this, &folder](const Diagnostic& d) { texts.push_back(folder.strip(d.to_string())); };
  }
  bool contain(const std::string& part) const {
    for (const std::string& text : texts)
      if (text.find(part) != std::string::npos) return true;
    return false;
  }
};

}  // namespace kiloband::test
