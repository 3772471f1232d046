// Powers of ten that stand by a unit: "10^-3 W/m2/nm".
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>

namespace kiloband {

/// Whether "(1000 W/m2/nm)" is a factor; of lengths, "(10 nm)", it is an amount.
enum class PlainPowers { kInBrackets, kNever };

/// The place [begin, end) of a unit in a text (in ASCII: units_in_ascii), with the power of ten that stands before it ("10^-3", "1e-3", "x1000",
/// or, if `plain` says so, in brackets together with the unit "(1000 W/m2/nm)") and the one behind it ("x 10^3", "* 1000"). Other numbers before a unit are
/// amounts ("a step of 10 nm").
std::pair<std::size_t, std::size_t> with_powers_of_ten(std::string_view text, std::size_t begin,
                                                       std::size_t end, PlainPowers plain);

/// Whether the text is a power of ten that is no number of its own: "10^-3", "x1000".
bool is_bare_power_of_ten(std::string_view text);

}  // namespace kiloband
