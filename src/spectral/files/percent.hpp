// Percent as the unit of a column, and not as the share of something else.
#pragma once

#include <string_view>

namespace kiloband {

/// Whether a column's name gives its values in percent: "%", "percent", "pct" or "percentage" alone, in
/// brackets of its own ("R (%)", "[in percent]"), directly behind or before a quantity ("reflectance %",
/// "percent reflectance", "%R"), or as the last word ("leaf_percent"). Behind a number it is a share ("10%
/// moisture"), behind "not" none. Lines of a header are separated by ';'.
bool says_percent(std::string_view name);

/// The same for a comment, which may speak of other things: brackets and last words count behind a quantity
/// alone ("humidity (%)" is none).
bool comment_says_percent(std::string_view comment);

}  // namespace kiloband
