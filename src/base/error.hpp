// Errors by who must act: the user (InputError, exit 2), the machine (DeviceError, exit 3), us
// (std::logic_error, exit 70).
#pragma once

#include <stdexcept>
#include <string>

namespace kiloband {

/// Where something stands in a text file. line and column are 1-based and count bytes; 0 means unknown.
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;

  /// "file:line:column", "file:line" or "file", as far as known.
  std::string to_string() const;
};

/// The user's input is wrong: a scene, a mesh, a spectrum, a cube, an option.
/// Loaders throw it with a plain message ("a.ply:7: face 2: index 9 ..."),
/// the scene reader puts its position in front.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  /// what() is "file:line:column: error: message".
  InputError(const SourcePosition& position, const std::string& message);

  /// Where it stands; without a file if that is not known.
  const SourcePosition& position() const { return position_; }

 private:
  SourcePosition position_;
};

/// The device or the machine failed: out of memory, disk full, no instruction set, a lost device.
class DeviceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace kiloband
