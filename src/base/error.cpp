#include "base/error.hpp"

namespace kiloband {

std::string SourcePosition::to_string() const {
  std::string text = file;
  if (line > 0) text.append(1, ':').append(std::to_string(line));
  if (line > 0 && column > 0) text.append(1, ':').append(std::to_string(column));
  return text;
}

InputError::InputError(const SourcePosition& position, const std::string& message)
    : std::runtime_error(position.to_string() + ": error: " + message), position_(position) {}

}  // namespace kiloband
