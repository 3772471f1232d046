#include "base/number.hpp"

#include <cmath>
#include <cstdlib>
#include <string>
#include <type_traits>

namespace kiloband {
namespace {

/// from_chars reports too large and too small alike; strtod tells them apart. Rare: its copy does not matter.
template <class Real>
NumberText read_out_of_range(std::string_view text, Real& value) {
  const std::string copy(text);
  if constexpr (std::is_same_v<Real, float>) {
    value = std::strtof(copy.c_str(), nullptr);
  } else {
    value = std::strtod(copy.c_str(), nullptr);
  }
  return std::isfinite(value) ? NumberText::kTooSmall : NumberText::kTooLarge;
}

template <class Real>
NumberText read_real(std::string_view text, Real& value) {
  // from_chars knows no plus sign; "+-1" must not slip through.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const char* end = text.data() + text.size();
  Real read = 0;
  const auto [stop, error] = std::from_chars(text.data(), end, read);
  if (error == std::errc::invalid_argument || stop != end) return NumberText::kNone;
  if (error == std::errc::result_out_of_range) return read_out_of_range(text, value);
  value = read;
  return NumberText::kNumber;
}

}  // namespace

NumberText read_number(std::string_view text, float& value) {
  return read_real(text, value);
}
NumberText read_number(std::string_view text, double& value) {
  return read_real(text, value);
}

}  // namespace kiloband
