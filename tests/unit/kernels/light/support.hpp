// What the tests of device code share: random inputs, one item's input and output, comparison.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "tests/support/device_scene.hpp"
#include "tests/support/opencl_probe.hpp"

namespace kiloband::test {

/// Input and output of one work-item; the same structs stand in kProbeHead.
struct ItemIn {
  float f[16];
  uint32_t u[4];
};
struct ItemOut {
  float f[20];
  uint32_t u[4];
};

inline const char* const kProbeHead = R"(
typedef struct { float f[16]; uint u[4]; } ItemIn;
typedef struct { float f[20]; uint u[4]; } ItemOut;
#define VEC3(i) ((float3)(in->f[i], in->f[(i) + 1], in->f[(i) + 2]))
#define VEC2(i) ((float2)(in->f[i], in->f[(i) + 1]))
#define PUT3(i, v) vstore3(v, 0, out->f + (i))
#define ITEM const size_t item = get_global_id(0); __global const ItemIn* in = all_in + item; \
  __global ItemOut* out = all_out + item; KB_SCENE_INIT(scene); (void)scene;
#define ARGS KB_SCENE_PARAMS, __global const ItemIn* restrict all_in, __global ItemOut* restrict all_out
)";

class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  /// Multiples of 2^-24 in [0, 1), as the renderer's.
  float unit() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  float between(double low, double high) { return static_cast<float>(low + (high - low) * unit()); }
  uint32_t index(uint32_t count) { return engine_() % count; }
  glm::dvec3 direction() {
    const double z = 2.0 * unit() - 1, phi = 6.283185307179586 * unit(),
                 r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::mt19937 engine_;
};

inline void put(ItemIn& item, int at, glm::vec3 v) {
  for (int i = 0; i < 3; ++i) item.f[at + i] = v[i];
}
inline glm::vec3 get3(const ItemIn& item, int at) {
  return {item.f[at], item.f[at + 1], item.f[at + 2]};
}
inline glm::vec3 get3(const ItemOut& item, int at) {
  return {item.f[at], item.f[at + 1], item.f[at + 2]};
}
inline glm::vec2 get2(const ItemIn& item, int at) {
  return {item.f[at], item.f[at + 1]};
}
inline glm::vec2 get2(const ItemOut& item, int at) {
  return {item.f[at], item.f[at + 1]};
}

/// Runs `kernel` of a program that is built once per test process.
inline std::vector<ItemOut> run_items(OpenclProbe& probe, const char* kernel, const FlatScene& scene,
                                      const std::vector<ItemIn>& in) {
  DeviceScene device(probe, scene);
  const cl::Buffer out = probe.upload(std::vector<ItemOut>(in.size()));
  device.run(kernel, in.size(), probe.upload(in), out);
  return probe.download<ItemOut>(out, in.size());
}

/// The same with an array of its own as third argument.
template <class T>
std::vector<ItemOut> run_items(OpenclProbe& probe, const char* kernel, const FlatScene& scene,
                               const std::vector<ItemIn>& in, const std::vector<T>& extra) {
  DeviceScene device(probe, scene);
  const cl::Buffer out = probe.upload(std::vector<ItemOut>(in.size()));
  device.run(kernel, in.size(), probe.upload(in), out, probe.upload(extra));
  return probe.download<ItemOut>(out, in.size());
}

/// The largest difference of two vectors' coordinates; NaN counts as infinite.
template <glm::length_t N, class T, class U>
double difference(const glm::vec<N, T>& a, const glm::vec<N, U>& b) {
  double largest = 0;
  for (glm::length_t i = 0; i < N; ++i) {
    const double d = std::fabs(double(a[i]) - double(b[i]));
    largest = d <= largest ? largest : (std::isnan(d) ? HUGE_VAL : d);
  }
  return largest;
}

/// |a - b| / |b|; 0 if both are 0 or the same infinity.
inline double relative(double a, double b) {
  if (a == b) return 0;
  const double d = std::fabs(a - b) / std::fabs(b);
  return std::isnan(d) ? HUGE_VAL : d;
}

/// Differences of texture coordinates that wrap around.
inline double periodic(double a, double b) {
  const double d = std::fabs(a - b);
  return std::fmin(d, std::fabs(1 - d));
}

}  // namespace kiloband::test
