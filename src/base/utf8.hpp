// Which bytes are UTF-8.
#pragma once

#include <cstddef>
#include <string_view>

namespace kiloband {

/// Length of the valid UTF-8 sequence at `i`, 0 if it is invalid
/// (RFC 3629: no overlong forms, no surrogates).
std::size_t utf8_length(std::string_view text, std::size_t i);

/// Whether the text is made of such sequences.
bool is_utf8(std::string_view text);

}  // namespace kiloband
