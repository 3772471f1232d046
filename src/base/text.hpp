// Numbers and names as text, in no locale.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kiloband {

/// The shortest text that reads back as the same value: "0.1", "1e-96", "nan", "inf".
std::string format_number(double value);
std::string format_number(float value);

/// Without the blanks at both ends. Line ends count as blanks: text comes from every system.
std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r\n\v\f");
/// ASCII's letters in lower case.
std::string lowered(std::string_view text);
/// ".exr" of "A.EXR".
std::string lowered_extension(const std::filesystem::path& file);
void replace_all(std::string& text, std::string_view from, std::string_view to);

/// The text in single quotes for a message: at most 40 bytes, bytes outside printable ASCII as '?'.
std::string quote_text(std::string_view text);

}  // namespace kiloband
