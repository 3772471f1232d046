// Which sanitizer a test is built with. Few tests ask: those of limits that are too narrow for a sanitizer's own needs.
#pragma once

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

}  // namespace kiloband::test
