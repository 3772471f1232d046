// What tests do less or more of: which sanitizer a test is built with (few ask: those of limits that are too narrow for a sanitizer's own
// needs), and whether it is to take all of many like cases.
#pragma once

#include <cstdlib>
#include <vector>

namespace kiloband::test {

#if defined(__has_feature)
#define KILOBAND_HAS_FEATURE(feature) __has_feature(feature)
#else
#define KILOBAND_HAS_FEATURE(feature) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || KILOBAND_HAS_FEATURE(address_sanitizer)
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif
#if defined(__SANITIZE_THREAD__) || KILOBAND_HAS_FEATURE(thread_sanitizer)
inline constexpr bool kThreadSanitizer = true;
#else
inline constexpr bool kThreadSanitizer = false;
#endif

/// KILOBAND_THOROUGH is set.
inline bool thorough() {
  return std::getenv("KILOBAND_THOROUGH") != nullptr;
}

/// `some`, and where tests are to be thorough the `others`, too.
template <typename T>
std::vector<T> with_others_if_thorough(std::vector<T> some, const std::vector<T>& others) {
  if (thorough()) some.insert(some.end(), others.begin(), others.end());
  return some;
}

}  // namespace kiloband::test
