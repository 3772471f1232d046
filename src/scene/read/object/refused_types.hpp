// Types of Mitsuba's that are not read, and what to do instead.
#pragma once

#include <string_view>

namespace kiloband {

/// "no such model; ...": why an element of that type is refused, and what serves where something does; empty for types that nobody has.
std::string_view why_refused(std::string_view tag, std::string_view type);

}  // namespace kiloband
