#include "src_cpu/lanes/isa.hpp"

#include "base/simd_targets.hpp"
// Before Highway, which it tells what there is code for.
#include <hwy/targets.h>

#include <cstdint>
#include <string>

#include "base/error.hpp"

namespace kiloband::cpu {
namespace {

/// By Isa: its name, and Highway's bits. SSE4 includes AES and PCLMUL, AVX2 includes FMA, BMI2 and F16C, and
/// AVX3 is AVX-512 F, BW, CD, DQ and VL.
constexpr struct {
  const char* name;
  int64_t target;
} kSets[] = {{"auto", 0}, {"sse4", HWY_SSE4}, {"avx2", HWY_AVX2}, {"avx512", HWY_AVX3}};

}  // namespace

std::optional<Isa> find_isa(std::string_view name) {
  for (const Isa isa : {Isa::kAuto, Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (name == to_string(isa)) return isa;
  }
  return {};
}

const char* to_string(Isa isa) {
  return kSets[static_cast<int>(isa)].name;
}

bool is_available(Isa isa) {
  return isa == Isa::kAuto ||
         (hwy::SupportedTargets() & HWY_TARGETS & kSets[static_cast<int>(isa)].target) != 0;
}

Isa resolve_isa(Isa wanted) {
  if (wanted == Isa::kAuto) {
    for (Isa isa : {Isa::kAvx512, Isa::kAvx2, Isa::kSse4})
      if (is_available(isa)) return isa;
    throw DeviceError("this processor has no SSE4.2, which is the least that kiloband needs");
  }
  if (!is_available(wanted))
    throw DeviceError(std::string("instruction set '") + to_string(wanted) +
                      "': this processor does not have it, or the program no code for it");
  return wanted;
}

}  // namespace kiloband::cpu
