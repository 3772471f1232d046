// Vectors of three numbers in each lane, and orthonormal frames.
//
// For one lane or a vector of them: see one_lane.hpp and highway_lanes-inl.hpp, one of which comes first.
#if defined(KILOBAND_VECTOR3_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KILOBAND_VECTOR3_INL
#undef KILOBAND_VECTOR3_INL
#else
#define KILOBAND_VECTOR3_INL
#endif

KB_BEFORE_LANES;
namespace kiloband::cpu::KB_LANES {

struct V2 {
  F x, y;
};

struct V3 {
  F x, y, z;
};

KB_INLINE V3 operator+(V3 a, V3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
KB_INLINE V3 operator-(V3 a, V3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
KB_INLINE V3 operator-(V3 a) {
  return {-a.x, -a.y, -a.z};
}
KB_INLINE V3 operator*(V3 a, F s) {
  return {a.x * s, a.y * s, a.z * s};
}
KB_INLINE V3 operator/(V3 a, F s) {
  return {a.x / s, a.y / s, a.z / s};
}
KB_INLINE F dot(V3 a, V3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
KB_INLINE V3 cross(V3 a, V3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
KB_INLINE F length(V3 a) {
  return sqrt(dot(a, a));
}
KB_INLINE V3 normalize(V3 a) {
  return a * (F(1) / length(a));
}
KB_INLINE V3 select(M m, V3 yes, V3 no) {
  return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}
/// The lanes of m, one after another; writes kLanes elements of each array.
KB_INLINE void store_chosen(V3 a, M m, float* x, float* y, float* z) {
  store_chosen(a.x, m, x), store_chosen(a.y, m, y), store_chosen(a.z, m, z);
}
KB_INLINE F largest(V3 a) {
  return max(max(a.x, a.y), a.z);
}
KB_INLINE V3 abs(V3 a) {
  return {abs(a.x), abs(a.y), abs(a.z)};
}
/// By a row-major 3x4 matrix: its linear part, and with its translation.
/// Number  float: all lanes share it; F
template <class Number>
KB_INLINE V3 transform_vector(const Number (&m)[12], V3 v) {
  return {F(m[0]) * v.x + F(m[1]) * v.y + F(m[2]) * v.z, F(m[4]) * v.x + F(m[5]) * v.y + F(m[6]) * v.z,
          F(m[8]) * v.x + F(m[9]) * v.y + F(m[10]) * v.z};
}
template <class Number>
KB_INLINE V3 transform_point(const Number (&m)[12], V3 p) {
  return transform_vector(m, p) + V3{F(m[3]), F(m[7]), F(m[11])};
}

}  // namespace kiloband::cpu::KB_LANES
KB_AFTER_LANES;

#endif
