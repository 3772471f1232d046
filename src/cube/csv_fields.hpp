// Fields of our CSV files.
#pragma once

#include <string>

#include "base/text.hpp"
#include "spectral/channels.hpp"

namespace kiloband {

/// RFC 4180: quoted where a comma, a quote or a line break would confuse.
inline std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// A channel's bound in nm; nothing for derived bands without wavelengths.
inline std::string csv_bound(const Channel& c, double nm) {
  return c.min_nm < c.max_nm ? format_number(nm) : "";
}

}  // namespace kiloband
