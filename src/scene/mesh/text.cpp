#include "scene/mesh/text.hpp"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <type_traits>

namespace kiloband {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

// from_chars reports underflow and overflow alike; strtod tells them apart.
// Rare, so its copy does not matter.
template <typename Real>
const char* parse_out_of_range(std::string_view token, Real& value) {
  const std::string copy(token);
  if constexpr (std::is_same_v<Real, float>) {
    value = std::strtof(copy.c_str(), nullptr);
    return std::isfinite(value) ? nullptr : "is too large for a float";
  } else {
    value = std::strtod(copy.c_str(), nullptr);
    return std::isfinite(value) ? nullptr : "is too large";
  }
}

template <typename Real>
const char* parse_real(std::string_view token, Real& value) {
  // from_chars knows no plus sign; "+-1" must not slip through.
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end) return "is not a number";
  if (error == std::errc::result_out_of_range) return parse_out_of_range(token, value);
  return std::isfinite(value) ? nullptr : "is not finite";
}

}  // namespace

const char* parse_number(std::string_view token, float& value) {
  return parse_real(token, value);
}
const char* parse_number(std::string_view token, double& value) {
  return parse_real(token, value);
}

std::string_view LineTokens::next() {
  size_t begin = 0;
  while (begin < rest_.size() && is_blank(rest_[begin])) ++begin;
  size_t end = begin;
  while (end < rest_.size() && !is_blank(rest_[end])) ++end;
  const std::string_view token = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return token;
}

std::string_view take_line(std::string_view& text) {
  const size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

std::string_view TokenStream::next() {
  size_t begin = 0;
  for (; begin < rest_.size(); ++begin) {
    if (rest_[begin] == '\n') {
      ++line_;
    } else if (!is_blank(rest_[begin])) {
      break;
    }
  }
  size_t end = begin;
  while (end < rest_.size() && rest_[end] != '\n' && !is_blank(rest_[end])) ++end;
  const std::string_view token = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return token;
}

}  // namespace kiloband
