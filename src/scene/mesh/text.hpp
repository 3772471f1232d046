// Tokens and strict numbers for the text formats.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "base/text.hpp"

namespace kiloband {

/// Reads the whole token as a decimal number.
/// value    the nearest float; a magnitude too small for a float becomes 0 or a denormal
/// returns  nullptr, or what is wrong with the token: "is not a number", "is not finite",
///          "is too large for a float"
const char* parse_number(std::string_view token, float& value);
/// The same for double, "is too large".
const char* parse_number(std::string_view token, double& value);

/// Splits text at blanks (space, tab, carriage return, vertical tab, form feed).
class LineTokens {
 public:
  explicit LineTokens(std::string_view line) : rest_(line) {}
  /// The next token, or an empty view at the end of the line.
  std::string_view next();

 private:
  std::string_view rest_;
};

/// Takes one line off the front of `text`, without its newline.
std::string_view take_line(std::string_view& text);

/// Tokens of a whole text across its lines.
class TokenStream {
 public:
  /// first_line  the number of the text's first line
  TokenStream(std::string_view text, size_t first_line) : rest_(text), line_(first_line) {}
  /// The next token, or an empty view at the end of the text. line() is then the token's line.
  std::string_view next();
  size_t line() const { return line_; }

 private:
  std::string_view rest_;
  size_t line_;
};

}  // namespace kiloband
