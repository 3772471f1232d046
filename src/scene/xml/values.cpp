#include "scene/xml/values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "base/number.hpp"

namespace kiloband {
namespace {

constexpr std::string_view kBlank = " ";  // the parser has made it of all others

/// A user's text for a message: long ones are cut.
std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  if (text.size() <= kLongest) return "'" + std::string(text) + "'";
  return "'" + std::string(text.substr(0, kLongest)) + "...'";
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

}  // namespace

std::vector<std::string_view> split_tokens(std::string_view text) {
  std::vector<std::string_view> tokens;
  std::size_t begin = 0;
  while ((begin = text.find_first_not_of(" ,", begin)) != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(" ,", begin), text.size());
    tokens.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return tokens;
}

double parse_number(std::string_view text, const Place& place, const std::string& context) {
  double value = 0;
  const NumberText number = read_number(trimmed(text, kBlank), value);
  if (number == NumberText::kNone) fail(place, context + quoted(text) + " is not a number");
  if (number != NumberText::kNumber) fail(place, context + quoted(text) + " is outside the range of numbers");
  if (!std::isfinite(value)) fail(place, context + quoted(text) + " is not finite");
  return value;
}

int64_t parse_integer(std::string_view text, const Place& place, const std::string& context) {
  std::string_view digits = trimmed(text, kBlank);
  if (digits.starts_with('+') && digits.size() > 1 && digits[1] != '-') digits.remove_prefix(1);
  int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
    fail(place, context + quoted(text) + " is not an integer");
  if (error != std::errc{}) fail(place, context + quoted(text) + " is outside the range of integers");
  return value;
}

bool parse_boolean(std::string_view text, const Place& place, const std::string& context) {
  const std::string lower = lowered(trimmed(text, kBlank));
  if (lower != "true" && lower != "false")
    fail(place, context + quoted(text) + " is neither 'true' nor 'false'");
  return lower == "true";
}

std::vector<double> parse_numbers(std::string_view text, const Place& place, const std::string& context) {
  std::vector<double> numbers;
  for (const std::string_view token : split_tokens(text))
    numbers.push_back(parse_number(token, place, context));
  return numbers;
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& candidates) {
  if (word.size() > 100) return {};
  const std::size_t size = word.size();
  std::size_t best = (size < 2 ? 0 : size < 4 ? 1 : std::clamp<std::size_t>(size / 3, 2, 3)) + 1;
  std::string_view nearest;
  const std::string lower = lowered(word);
  for (const std::string_view candidate : candidates) {
    if (candidate != word && lowered(candidate) == lower) {
      nearest = candidate;
      break;
    }
    const std::size_t longer = std::max(size, candidate.size()), shorter = std::min(size, candidate.size());
    if (longer - shorter >= best) continue;  // the distance is at least that
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best) best = distance, nearest = candidate;
  }
  return nearest.empty() ? std::string() : "; did you mean '" + std::string(nearest) + "'?";
}

}  // namespace kiloband
