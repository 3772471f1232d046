// The one header that asks which language it is compiled as: C++20 on the host, OpenCL C 1.2 on devices.
//
// Everything in src/shared is valid in both. Rules: no overloads, templates, references, size_t, bool or
// vector types in stored records; `fma` only where it is written; compile with -ffp-contract=off.
#ifndef KILOBAND_SHARED_LANG_H
#define KILOBAND_SHARED_LANG_H

#if defined(__OPENCL_VERSION__) || defined(__OPENCL_C_VERSION__)

#pragma OPENCL FP_CONTRACT OFF
typedef uint kb_u32;
typedef ulong kb_u64;
typedef int kb_i32;
typedef ushort kb_u16;
#define KB_FN static inline
#ifdef KB_UNDER_OCLGRIND /* which lacks the instruction that LLVM makes of a reversal of bits */
#define KB_REVERSAL_FN static __attribute__((noinline, optnone))
#else
#define KB_REVERSAL_FN KB_FN
#endif
#define KB_ROLLED
#define KB_GLOBAL __global
#define KB_TABLE __constant /* an array of constants at file scope */
#define KB_STATIC_ASSERT(condition, name) typedef char kb_assert_##name[(condition) ? 1 : -1]
#define kb_sqrt(x) sqrt(x)
#define kb_fabs(x) fabs(x)
#define kb_floor(x) floor(x)
#define kb_fmin(x, y) fmin(x, y)
#define kb_fmax(x, y) fmax(x, y)
#define kb_sin(x) sin(x)
#define kb_cos(x) cos(x)
#define kb_log(x) log(x)
#define kb_popcount(x) popcount(x)
#define kb_as_u32(x) as_uint(x)
#define kb_as_f32(x) as_float(x)
/* Four u32 in one register, for local variables only: + - * & | ^ << >> work by element, with a scalar too. */
typedef uint4 kb_u32x4;
#define kb_u32x4_of(a, b, c, d) ((uint4)(a, b, c, d))
#define kb_u32x4_load(table, index) (((KB_GLOBAL const uint4*)(table))[index]) /* aligned to 16 bytes */
#define kb_u32x4_x(v) ((v).x)
#define kb_u32x4_y(v) ((v).y)
#define kb_u32x4_z(v) ((v).z)
#define kb_u32x4_w(v) ((v).w)

#else

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
typedef uint32_t kb_u32;
typedef uint64_t kb_u64;
typedef int32_t kb_i32;
typedef uint16_t kb_u16;
#define KB_FN static inline
#define KB_REVERSAL_FN KB_FN
/* Before a loop of four: compilers make one vector of it, unless they unroll it first. */
#define KB_ROLLED _Pragma("GCC unroll 1")
#define KB_GLOBAL
#define KB_TABLE alignas(64) inline constexpr
#define KB_STATIC_ASSERT(condition, name) static_assert(condition, #name)
#define kb_sqrt(x) std::sqrt(x)
#define kb_fabs(x) std::fabs(x)
#define kb_floor(x) std::floor(x)
#define kb_fmin(x, y) std::fmin(x, y)
#define kb_fmax(x, y) std::fmax(x, y)
#define kb_sin(x) std::sin(x)
#define kb_cos(x) std::cos(x)
#define kb_log(x) std::log(x)
KB_FN kb_u32 kb_popcount(kb_u32 x) {
  return (kb_u32)__builtin_popcount(x);
}
KB_FN kb_u32 kb_as_u32(float x) {
  kb_u32 bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
KB_FN float kb_as_f32(kb_u32 bits) {
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
typedef kb_u32 kb_u32x4 __attribute__((vector_size(16)));
KB_FN kb_u32x4 kb_u32x4_of(kb_u32 a, kb_u32 b, kb_u32 c, kb_u32 d) {
  return kb_u32x4{a, b, c, d};
}
KB_FN kb_u32x4 kb_u32x4_load(const kb_u32* table, kb_u32 index) {
  kb_u32x4 v;
  std::memcpy(&v, table + 4 * static_cast<std::size_t>(index), sizeof v);
  return v;
}
#define kb_u32x4_x(v) ((v)[0])
#define kb_u32x4_y(v) ((v)[1])
#define kb_u32x4_z(v) ((v)[2])
#define kb_u32x4_w(v) ((v)[3])

#endif

/* What devices read and write as whole vectors begins at a multiple of their size. */
#define KB_ALIGNED(bytes) __attribute__((aligned(bytes)))

#define KB_PI 3.14159265358979323846f
#define KB_INV_PI 0.31830988618379067154f
#define KB_ONE_MINUS_EPSILON 0.99999994f

typedef struct {
  float x, y;
} KB_ALIGNED(8) KbFloat2;

typedef struct {
  float x, y, z;
} KbFloat3;

typedef struct {
  float x, y, z, w;
} KB_ALIGNED(16) KbFloat4;

KB_STATIC_ASSERT(sizeof(KbFloat2) == 8, float2_size);
KB_STATIC_ASSERT(sizeof(KbFloat3) == 12, float3_size);
KB_STATIC_ASSERT(sizeof(KbFloat4) == 16, float4_size);

#endif
