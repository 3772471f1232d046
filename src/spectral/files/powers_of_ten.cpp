#include "spectral/files/powers_of_ten.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "base/text.hpp"
#include "spectral/files/text_table.hpp"
#include "spectral/files/unit_names.hpp"

namespace kiloband {
namespace {

constexpr std::string_view kOfNumbers = "0123456789.^{}()+-eE";

bool is_open(char c) {
  return c == '(' || c == '[';
}
bool is_times(char c) {
  return c == '*' || c == 'x' || c == 'X';
}

/// 10-3 and 10+6 are powers, 10-12 is a range.
bool has_bare_exponent(std::string_view digits) {
  return digits.size() == 4 && (digits.starts_with("10-") || digits.starts_with("10+")) &&
         is_ascii_digit(digits[3]);
}

/// What 10^-3, 10^{3}, 10-3, 1e-3 and 1000 are; empty for all else, and for 1.
std::optional<double> power_of_ten(std::string_view text) {
  std::string digits(text);
  for (const char* bracket : {"{", "}", "(", ")"}) replace_all(digits, bracket, "");
  const bool raised = digits.starts_with("10^") || has_bare_exponent(digits);
  if (raised) digits = "1e" + digits.substr(digits[2] == '^' ? 3 : 2);
  const std::optional<double> value = to_number(digits);
  if (!value || !(*value > 0) || *value == 1) return std::nullopt;
  const double exponent = std::round(std::log10(*value));
  return std::abs(std::log10(*value) - exponent) < 1e-9 ? value : std::nullopt;
}

bool is_plain(std::string_view number) {
  return number.find_first_of("^eE+-") == std::string_view::npos;
}

/// Where the number that ends at `end` begins.
std::size_t begin_of_number(std::string_view text, std::size_t end) {
  while (end > 0 && kOfNumbers.find(text[end - 1]) != std::string_view::npos) --end;
  return end;
}

std::size_t skip_back(std::string_view text, std::size_t at, std::string_view what) {
  while (at > 0 && what.find(text[at - 1]) != std::string_view::npos) --at;
  return at;
}

/// Whether the character before `at` is a "times" that is no letter of a word.
bool is_behind_times(std::string_view text, std::size_t at) {
  if (at == 0 || !is_times(text[at - 1])) return false;
  return at == 1 || std::string_view(" ([0123456789").find(text[at - 2]) != std::string_view::npos;
}

/// A number is a factor if it looks like one: with an exponent, behind a "times", or alone in brackets with the unit.
std::size_t begin_with_factor(std::string_view text, std::size_t begin, std::size_t end, PlainPowers plain) {
  const std::size_t behind = skip_back(text, begin, " *x([");
  std::size_t first = begin_of_number(text, behind);
  while (first < behind && is_open(text[first])) ++first;
  const std::string_view number = text.substr(first, behind - first);
  if (!power_of_ten(number)) return begin;
  const std::size_t before = skip_back(text, first, " ");
  if (is_behind_times(text, before)) return before - 1;
  const bool in_word = first > 0 && std::isalpha(static_cast<unsigned char>(text[first - 1])) != 0;
  const bool is_closed = end < text.size() && (text[end] == ')' || text[end] == ']');
  const bool bracketed =
      plain == PlainPowers::kInBrackets && before > 0 && is_open(text[before - 1]) && is_closed;
  return !in_word && (bracketed || !is_plain(number)) ? first : begin;
}

std::size_t end_with_factor(std::string_view text, std::size_t end) {
  std::size_t at = text.find_first_not_of(" )]", end);
  if (at == std::string_view::npos) return end;
  const bool times = is_times(text[at]);
  if (times) at = text.find_first_not_of(' ', at + 1);
  if (at == std::string_view::npos) return end;
  const std::size_t behind = std::min(text.find_first_not_of("0123456789.^{}+-eE", at), text.size());
  const std::string_view number = text.substr(at, behind - at);
  return power_of_ten(number) && (times || !is_plain(number)) ? behind : end;
}

}  // namespace

bool is_bare_power_of_ten(std::string_view text) {
  const bool times = !text.empty() && is_times(text.front());
  const std::string_view number = text.substr(times ? 1 : 0);
  return power_of_ten(number) && (times || !to_number(number));
}

std::pair<std::size_t, std::size_t> with_powers_of_ten(std::string_view text, std::size_t begin,
                                                       std::size_t end, PlainPowers plain) {
  return {begin_with_factor(text, begin, end, plain), end_with_factor(text, end)};
}

}  // namespace kiloband
