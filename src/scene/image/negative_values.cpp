#include "scene/image/negative_values.hpp"

#include <array>
#include <charconv>

namespace kiloband {

std::string NegativeValues::rule() const {
  const std::string rule = "must be finite and >= 0";
  if (!(least() < 0)) return rule;
  std::array<char, 32> text;
  char* const end =
      std::to_chars(text.data(), text.data() + text.size(), least(), std::chars_format::general, 3).ptr;
  return rule + " (down to " + std::string(text.data(), end) + ", 1 % of the mean, is taken as 0)";
}

}  // namespace kiloband
