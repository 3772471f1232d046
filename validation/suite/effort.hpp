// How much a validation run does.
#pragma once

namespace kiloband::validation {

/// A minute or two; tens of minutes; as long as it takes.
enum class Effort { kQuick, kStandard, kThorough };

inline const char* name_of(Effort effort) {
  return effort == Effort::kQuick ? "quick" : effort == Effort::kStandard ? "default" : "thorough";
}

/// What each effort takes of something.
template <class T>
struct ByEffort {
  T quick, standard, thorough;
  const T& at(Effort effort) const {
    return effort == Effort::kQuick ? quick : effort == Effort::kStandard ? standard : thorough;
  }
};

}  // namespace kiloband::validation
