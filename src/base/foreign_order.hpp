// For ThreadSanitizer: an order of memory accesses that a library guarantees which it cannot follow, such as TBB inside Embree.
// Nothing in other builds.
#pragma once

#if defined(__SANITIZE_THREAD__)
#define KILOBAND_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define KILOBAND_THREAD_SANITIZER 1
#endif
#endif

#ifdef KILOBAND_THREAD_SANITIZER
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace kiloband {

/// Stands in every callback of the library, and around the call that runs them: each sees what those that ended before it
/// have written. `token` says which order is meant; it is not accessed.
class ForeignOrder {
 public:
#ifdef KILOBAND_THREAD_SANITIZER
  explicit ForeignOrder(char& token) : token_(&token) {
    __tsan_acquire(token_);
  }
  ~ForeignOrder() {
    __tsan_release(token_);
  }
  /// In the middle of the call: before it starts the callbacks, or after they have ended.
  void pass() const {
    __tsan_release(token_), __tsan_acquire(token_);
  }

 private:
  char* token_;
#else
  explicit ForeignOrder(char&) {}
  ~ForeignOrder() {}  // not trivial, so that it is no unused variable
  void pass() const {}
#endif

 public:
  ForeignOrder(const ForeignOrder&) = delete;
  ForeignOrder& operator=(const ForeignOrder&) = delete;
};

}  // namespace kiloband
