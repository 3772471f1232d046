// Instruction sets that files which include themselves once per set (hwy/foreach_target.h) are compiled for: included before it.
// SSE4.2 with AES, AVX2 and AVX-512; with the CMake option KILOBAND_NATIVE the best of them that the building machine has.
#pragma once

#define HWY_DISABLED_TARGETS (HWY_SCALAR | HWY_EMU128 | HWY_SSSE3 | HWY_AVX3_DL)
#ifdef KILOBAND_NATIVE
#define HWY_COMPILE_ONLY_STATIC
#endif
