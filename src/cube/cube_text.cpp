#include "cube/cube_text.hpp"

#include <array>
#include <charconv>
#include <unordered_map>
#include <unordered_set>

#include "base/number.hpp"

namespace kiloband {
namespace {

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

/// Two upper-case digits.
std::string hex_byte(char c) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  const auto byte = static_cast<unsigned char>(c);
  return {kDigits[byte >> 4], kDigits[byte & 15]};
}

}  // namespace

std::string format_short(double value) {
  // 400 bytes hold every double in fixed notation with six decimals.
  std::array<char, 400> buffer;
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, 6).ptr;
  std::string text(buffer.data(), end);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  if (read_number(trimmed(text), value) != NumberText::kNumber) return std::nullopt;
  return value;
}

std::optional<uint64_t> parse_unsigned(std::string_view text) {
  return whole_number<uint64_t>(trimmed(text));
}

std::optional<std::vector<uint64_t>> parse_counts(std::string_view text) {
  std::vector<uint64_t> counts;
  for (const std::string_view part : split(text, ',')) {
    const auto count = parse_unsigned(part);
    if (!count) return std::nullopt;
    counts.push_back(*count);
  }
  return counts;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::string encode_text(std::string_view text, std::string_view special) {
  std::string encoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool outer_blank = c == ' ' && (i == 0 || i + 1 == text.size());
    if (is_control(c) || c == '%' || outer_blank || special.find(c) != std::string_view::npos)
      encoded += '%' + hex_byte(c);
    else
      encoded += c;
  }
  return encoded;
}

std::string decode_text(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;  // no sign is taken
    const bool escape =
        text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(text.data() + i + 1, text.data() + i + 3, byte, 16).ptr == text.data() + i + 3;
    decoded += escape ? static_cast<char>(byte) : text[i];
    if (escape) i += 2;
  }
  return decoded;
}

std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::string shown;
  for (const char c : text.substr(0, kLongest))
    shown += is_control(c) || static_cast<unsigned char>(c) >= 0x80 ? "\\x" + hex_byte(c) : std::string(1, c);
  return text.size() > kLongest ? shown + "..." : shown;
}

std::vector<std::string> make_unique_names(std::vector<std::string> names) {
  const std::unordered_set<std::string> originals(names.begin(), names.end());
  std::unordered_set<std::string> given;
  std::unordered_map<std::string, uint64_t> last;  // suffix that a name was last given
  for (std::string& name : names) {
    if (given.insert(name).second) continue;
    uint64_t& suffix = last.try_emplace(name, 1).first->second;
    std::string candidate;
    do {
      candidate = name + "_" + std::to_string(++suffix);
    } while (originals.contains(candidate) || given.contains(candidate));
    given.insert(candidate);
    name = candidate;
  }
  return names;
}

}  // namespace kiloband
