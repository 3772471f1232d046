// The table of lane_functions.hpp for the lanes of the file that includes this one.
#if defined(KILOBAND_LANE_FUNCTIONS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_LANE_FUNCTIONS_INL
#undef KILOBAND_LANE_FUNCTIONS_INL
#else
#define KILOBAND_LANE_FUNCTIONS_INL
#endif

#include "lane_functions.hpp"
#include "src_cpu/lanes/lane_access-inl.hpp"
#include "src_cpu/lanes/lane_math-inl.hpp"
#include "src_cpu/lanes/lane_sampler-inl.hpp"
#include "src_cpu/lanes/vector3-inl.hpp"

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

using Inputs = const float* const*;
using Outputs = float* const*;

#define KB_ARRAY_FUNCTION(name, body)                                       \
  void name##_of_arrays(Inputs in, Outputs out, std::size_t count) {        \
    for (std::size_t i = 0; i < count; i += kLanes) {                       \
      const auto a = [&](int k) KB_LAMBDA { return load(in[k] + i); };      \
      const auto put = [&](int k, F v) KB_LAMBDA { store(v, out[k] + i); }; \
      body                                                                  \
    }                                                                       \
  }

KB_ARRAY_FUNCTION(exp, { put(0, exp(a(0))); })
KB_ARRAY_FUNCTION(log, { put(0, log(a(0))); })
KB_ARRAY_FUNCTION(erf, { put(0, erf_positive(a(0))); })
KB_ARRAY_FUNCTION(erf_inverse, { put(0, erf_inverse(a(0))); })
KB_ARRAY_FUNCTION(turns, {
  const SinCos r = sin_cos_of_turns(a(0));
  put(0, r.sin);
  put(1, r.cos);
})
KB_ARRAY_FUNCTION(arc_tangent, { put(0, arc_tangent(a(0), a(1))); })
KB_ARRAY_FUNCTION(arithmetic, {
  const F x = a(0);
  const F y = a(1);
  put(0, x + y);
  put(1, x - y);
  put(2, x * y);
  put(3, x / y);
  put(4, sqrt(abs(x)));
  put(5, min(x, y));
  put(6, max(x, y));
  put(7, copysign(x, y));
  put(8, floor(x));
  put(9, select(x < y, -x, y));
})
KB_ARRAY_FUNCTION(words, {
  const U x = as_words(a(0));
  const U y = as_words(a(1));
  U high;
  U low;
  multiply_wide(x, 0xd2511f53u, high, low);
  put(0, as_floats(x + y));
  put(1, as_floats(x - y));
  put(2, as_floats(x * y));
  put(3, as_floats((x & y) ^ shift_left<7>(x | y)));
  put(4, as_floats(shift_right<9>(x) ^ shift_right(y, 9)));
  put(5, as_floats(reversed_bits(x)));
  put(6, as_floats(high));
  put(7, as_floats(low));
  put(8, select(has_bits(x, 5u), to_floats(shift_right<8>(x)), F(-1)));
  put(9, as_floats(to_words(to_floats(shift_right<4>(y)) * F(-0.5f))));
})
KB_ARRAY_FUNCTION(philox, {
  const U pixel = as_words(a(0));
  const U sample = as_words(a(1));
  const F4 u = sampler_block(KB_SAMPLER_INDEPENDENT, 0x123456789abcdefull,
                             {pixel, sample, U(0u), U(0u), U(0u)}, U(7u));
  put(0, u.x);
  put(1, u.y);
  put(2, u.z);
  put(3, u.w);
})
KB_ARRAY_FUNCTION(sobol, {
  const U index = as_words(a(0));
  const U key = as_words(a(1));
  const F4 u = sampler_block(KB_SAMPLER_SOBOL, 0, {U(0u), U(0u), index, key, key ^ U(0x9e3779b9u)}, U(5u));
  put(0, u.x);
  put(1, u.y);
  put(2, u.z);
  put(3, u.w);
})
KB_ARRAY_FUNCTION(sampler_keys, {
  const SamplerKeys keys = sampler_keys(0xfedcba9876543210ull, as_words(a(0)), 5, 3, 11);
  put(0, as_floats(keys.pixel));
  put(1, as_floats(keys.sample));
  put(2, as_floats(keys.reversed_index));
  put(3, as_floats(keys.key0));
  put(4, as_floats(keys.key1));
})
KB_ARRAY_FUNCTION(cosine_hemisphere, {
  const V3 w = cosine_hemisphere(a(0), a(1));
  put(0, w.x);
  put(1, w.y);
  put(2, w.z);
})
KB_ARRAY_FUNCTION(uniform_sphere, {
  const V3 w = uniform_sphere(a(0), a(1));
  put(0, w.x);
  put(1, w.y);
  put(2, w.z);
})
KB_ARRAY_FUNCTION(uniform_triangle, {
  const V2 b = uniform_triangle(a(0), a(1));
  put(0, b.x);
  put(1, b.y);
})
KB_ARRAY_FUNCTION(normalize, {
  const V3 n = normalize(cross({a(0), a(1), F(1)}, {a(1), F(0.5f), a(0)}));
  put(0, n.x);
  put(1, n.y);
  put(2, n.z);
})

KB_ARRAY_FUNCTION(doubles, {
  const D x = to_doubles(a(0));
  const D y = to_doubles(a(1));
  put(0, to_floats(x * y - y * y));
  put(1, to_floats(sqrt(x * x + y * y)));
  const D third = x / to_doubles(3.0);
  put(2, to_floats(third - floor(third)));
  put(3, to_floats(zero_beyond(third * y, 0.5)));
  put(4, to_floats(min(third, y) - third));
  put(5, to_floats(max(third, y) - third));
})

/// Members of records at places of in[0]'s bits; every third lane is replaced by its number.
inline void records_of_arrays(Inputs in, Outputs out, std::size_t count) {
  const auto* records = reinterpret_cast<const KbFloat2*>(in[1]);
  for (std::size_t i = 0; i < count; i += kLanes) {
    const U place = as_words(load(in[0] + i)) & U(static_cast<uint32_t>(count / 2 - 1));
    FloatArray value(KB_GATHER_FLOAT(records, KbFloat2, y, place));
    const U third = lane_numbers() + U(static_cast<uint32_t>(i));
    const M chosen = to_floats(third) * F(1.0f / 3) == floor(to_floats(third) * F(1.0f / 3));
    each_lane(chosen, [&](uint32_t lane) KB_LAMBDA { value[lane] = static_cast<float>(i + lane); });
    store(value, out[0] + i);
    store(as_floats(KB_GATHER_WORD(records, KbFloat2, x, place)), out[1] + i);
  }
}

/// Chosen lanes one after another; what is left of out[0] is 0.
inline void choose_of_arrays(Inputs in, Outputs out, std::size_t count) {
  std::vector<float> chosen(count + kLanes);
  std::vector<uint32_t> places(count + kLanes);
  std::size_t n = 0;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const F x = load(in[0] + i);
    const M m = (x < load(in[1] + i)) & first_lanes(static_cast<uint32_t>(count - i));
    store_chosen(x, m, &chosen[n]);
    store_chosen(lane_numbers() + U(static_cast<uint32_t>(i)), m, &places[n]);
    n += kiloband::cpu::KB_LANES::count(m);
  }
  for (std::size_t i = 0; i < count; ++i) out[0][i] = i < n ? chosen[i] : 0.0f;
  for (std::size_t i = 0; i < count; ++i) out[1][i] = i < n ? in[0][places[i]] : 0.0f;
}

/// Gathers from both inputs in another order.
inline void move_of_arrays(Inputs in, Outputs out, std::size_t count) {
  const auto size = static_cast<uint32_t>(count);
  for (std::size_t i = 0; i < count; i += kLanes) {
    const U place = (lane_numbers() + U(static_cast<uint32_t>(i))) * U(7u);
    const U at = place & U(size - 1);
    store(gather(in[0], at), out[0] + i);
    store(as_floats(gather(reinterpret_cast<const uint32_t*>(in[1]), at)), out[1] + i);
    store(gather_from_large(in[0], at), out[2] + i);
  }
}

inline std::vector<test::NamedFunction> named_functions() {
  return {{"exp", 1, 1, exp_of_arrays},
          {"log", 1, 1, log_of_arrays},
          {"erf", 1, 1, erf_of_arrays},
          {"erf_inverse", 1, 1, erf_inverse_of_arrays},
          {"turns", 1, 2, turns_of_arrays},
          {"arc_tangent", 2, 1, arc_tangent_of_arrays},
          {"arithmetic", 2, 10, arithmetic_of_arrays},
          {"words", 2, 10, words_of_arrays},
          {"philox", 2, 4, philox_of_arrays},
          {"sobol", 2, 4, sobol_of_arrays},
          {"sampler_keys", 1, 5, sampler_keys_of_arrays},
          {"cosine_hemisphere", 2, 3, cosine_hemisphere_of_arrays},
          {"uniform_sphere", 2, 3, uniform_sphere_of_arrays},
          {"uniform_triangle", 2, 2, uniform_triangle_of_arrays},
          {"normalize", 2, 3, normalize_of_arrays},
          {"choose", 2, 2, choose_of_arrays},
          {"move", 2, 3, move_of_arrays},
          {"doubles", 2, 6, doubles_of_arrays},
          {"records", 2, 2, records_of_arrays}};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
