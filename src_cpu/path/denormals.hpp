// How floats too small for their exponent are treated.
#pragma once

#include <xmmintrin.h>

namespace kiloband::cpu {

/// Denormals to zero while a thread renders (Embree's advice); the caller's mode comes back afterwards. What
/// a film computes from sums is outside: whichever thread does it gets the same bits.
class DenormalsToZero {
 public:
  DenormalsToZero() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
  ~DenormalsToZero() { _mm_setcsr(saved_); }
  DenormalsToZero(const DenormalsToZero&) = delete;
  DenormalsToZero& operator=(const DenormalsToZero&) = delete;

 private:
  unsigned saved_;
};

}  // namespace kiloband::cpu
