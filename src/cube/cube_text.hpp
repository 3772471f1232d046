// Numbers and names as cube headers spell them: locale-free, exact, and safe against foreign bytes.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.hpp"

namespace kiloband {
/// With at most six decimals, none that are zero: "550", "384.878049".
std::string format_short(double value);

/// The whole text as a number, blanks around it allowed; nothing if it is not one.
std::optional<double> parse_number(std::string_view text);
std::optional<uint64_t> parse_unsigned(std::string_view text);

/// "512, 31": whole numbers, blanks around them allowed; nothing if the text is not such a list.
std::optional<std::vector<uint64_t>> parse_counts(std::string_view text);

/// The parts look into `text`, which must outlive them: not a temporary string.
std::vector<std::string_view> split(std::string_view text, char separator);
template <std::same_as<std::string> Temporary>
std::vector<std::string_view> split(Temporary&& text, char separator) = delete;

/// Replaces control characters, '%' and those in `special` by %XX, and blanks at both ends;
/// decode_text undoes it.
std::string encode_text(std::string_view text, std::string_view special);
std::string decode_text(std::string_view text);

/// What is unsafe to print is shown as \xXX and long text is cut: for quoting foreign bytes in messages.
std::string printable(std::string_view text);

/// Makes names unique: the second of equal ones gets "_2", the third "_3" ... in order. A suffixed name that
/// is already another's name is passed over.
std::vector<std::string> make_unique_names(std::vector<std::string> names);

}  // namespace kiloband
