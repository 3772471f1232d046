// Words and numbers in attribute values, and suggestions for misspelt names.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.hpp"
#include "scene/xml/document.hpp"

namespace kiloband {

/// Splits at blanks and commas; empty tokens vanish, as in Mitsuba. The tokens look into `text`, which must
/// outlive them: not a temporary string.
std::vector<std::string_view> split_tokens(std::string_view text);
template <std::same_as<std::string> Temporary>
std::vector<std::string_view> split_tokens(Temporary&& text) = delete;

/// Whole-text conversions. `context` stands before the message.
/// throws InputError at `place`, e.g. "'abc' is not a number", "'nan' is not finite"
double parse_number(std::string_view text, const Place& place, const std::string& context = {});
int64_t parse_integer(std::string_view text, const Place& place, const std::string& context = {});
bool parse_boolean(std::string_view text, const Place& place, const std::string& context = {});
std::vector<double> parse_numbers(std::string_view text, const Place& place, const std::string& context = {});

/// "; did you mean 'x'?" for the candidate nearest in edit distance (at most a third of the word's length; 2
/// for 4 to 5 letters, 1 for 2 to 3, never more than 3) or different in case alone; empty if none is near. Ties: the first.
std::string suggestion(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace kiloband
