#include "base/text.hpp"

#include <charconv>

namespace kiloband {
namespace {

template <typename T>
std::string shortest(T value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return {buffer, result.ptr};
}

}  // namespace

std::string format_number(double value) {
  return shortest(value);
}
std::string format_number(float value) {
  return shortest(value);
}

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string lowered(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::string lowered_extension(const std::filesystem::path& file) {
  return lowered(file.extension().string());
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

std::string quote_text(std::string_view text) {
  constexpr std::size_t kMaxShown = 40;
  std::string result = "'";
  for (const char c : text.substr(0, kMaxShown)) result += (c >= ' ' && c <= '~') ? c : '?';
  return result + (text.size() > kMaxShown ? "...'" : "'");
}

}  // namespace kiloband
