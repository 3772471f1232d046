// Values of options that have units.
#pragma once

#include <string>

namespace kiloband {

/// "60", "60s", "5min", "2h" to seconds. option: its name, for messages.
/// throws InputError
double parse_duration(const std::string& option, const std::string& text);

/// "1%" or "0.01" to a fraction. From 1 on the % is needed: 1 alone would be 100 %, which nobody means.
/// throws InputError
double parse_error(const std::string& option, const std::string& text);

}  // namespace kiloband
