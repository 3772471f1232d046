// Numbers as text.
#pragma once

#include <string>

namespace kiloband {

/// The shortest text that reads back as the same value: "0.1", "1e-96", "nan", "inf".
std::string format_number(double value);
std::string format_number(float value);

}  // namespace kiloband
