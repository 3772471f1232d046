/* What NVIDIA's OpenCL compiler makes of these functions, an instruction for each lane; libclc's are correctly rounded quotients. */
static inline float kb_static_recip_of(float x) {
  float y;
  __asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(x));
  return y;
}
#define KB_STATIC_VECTORS(name, one)                                  \
  static inline __attribute__((overloadable)) float name(float x) {   \
    return one(x);                                                    \
  }                                                                   \
  static inline __attribute__((overloadable)) float2 name(float2 x) { \
    return (float2)(one(x.x), one(x.y));                              \
  }                                                                   \
  static inline __attribute__((overloadable)) float4 name(float4 x) { \
    return (float4)(one(x.x), one(x.y), one(x.z), one(x.w));          \
  }
KB_STATIC_VECTORS(kb_static_rsqrt, __nvvm_rsqrt_approx_f)
KB_STATIC_VECTORS(kb_static_recip, kb_static_recip_of)
#define rsqrt kb_static_rsqrt
#define native_recip kb_static_recip
