// One target as libFuzzer calls it. KILOBAND_FUZZ_TARGET: its name.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  kiloband::fuzz::KILOBAND_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
