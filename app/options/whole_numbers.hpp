// Whole numbers on the command line: decimal, whatever they begin with.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <concepts>
#include <cstdint>
#include <limits>
#include <string>

#include "base/number.hpp"

namespace kiloband {

/// Leaves the number as CLI11 reads it: by itself it takes 010 for 8, 0x10 for 16 and, of unsigned types, -1 for 2^64 - 1.
/// rule: what stands behind the value in the message that refuses it. For Option::transform(), which may change the text.
template <std::integral T>
CLI::Validator decimal_numbers(T least, T most, const std::string& rule, const std::string& description) {
  const auto read = [=](std::string& text) -> std::string {
    const auto value = whole_number<T>(text);
    if (!value || *value < least || *value > most) return "Value " + text + " " + rule;
    text = std::to_string(*value);
    return {};
  };
  return {read, description};
}

/// In the place of CLI::Range, with its words.
template <std::integral T>
CLI::Validator whole_numbers(T least, T most) {
  return decimal_numbers<T>(least, most, fmt::format("not in range {} to {}", least, most),
                            CLI::Range(least, most).get_description());
}

/// Of seeds, which no help needs a range for.
inline CLI::Validator any_whole_number() {
  constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();
  return decimal_numbers<uint64_t>(0, kMost, fmt::format("not a whole number from 0 to {}", kMost), "");
}

}  // namespace kiloband
