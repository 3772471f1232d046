// Numbers in text, in no locale.
#pragma once

#include <charconv>
#include <concepts>
#include <optional>
#include <string_view>

namespace kiloband {

/// What a text is as a number of some type.
enum class NumberText {
  kNumber,    // a number, "inf" or "nan"
  kNone,      // something else
  kTooLarge,  // a number that the type cannot hold
  kTooSmall,  // a number other than 0 that is nearer to 0 than the type's least
};

/// Reads the whole text as a decimal number; one plus sign may stand before it. No blanks.
/// value  the nearest number that the type has: of what is too large infinity, of what is too small 0 or a
///        denormal; unchanged for kNone
NumberText read_number(std::string_view text, float& value);
NumberText read_number(std::string_view text, double& value);

/// The text as a whole number without any sign but the minus of a signed type; nothing if it is none or does
/// not fit.
template <std::integral T>
std::optional<T> whole_number(std::string_view text) {
  T value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace kiloband
