#include "scene/mesh/text.hpp"

#include <cmath>

#include "base/number.hpp"

namespace kiloband {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

template <class Real>
const char* parse_real(std::string_view token, Real& value, const char* too_large) {
  const NumberText text = read_number(token, value);
  if (text == NumberText::kNone) return "is not a number";
  if (text == NumberText::kTooLarge) return too_large;
  return std::isfinite(value) ? nullptr : "is not finite";
}

}  // namespace

const char* parse_number(std::string_view token, float& value) {
  return parse_real(token, value, "is too large for a float");
}
const char* parse_number(std::string_view token, double& value) {
  return parse_real(token, value, "is too large");
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
