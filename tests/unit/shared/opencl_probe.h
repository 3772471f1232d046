// What opencl_device_test.cpp computes on host and device: one item's results, with the same code.
#ifndef KILOBAND_TESTS_OPENCL_PROBE_H
#define KILOBAND_TESTS_OPENCL_PROBE_H

#include "shared/filter_sample.h"
#include "shared/fresnel.h"
#include "shared/sampler.h"
#include "shared/spectrum_table.h"
#include "shared/warp.h"

#define KB_PROBE_EXACT 22 /* words an item, to be equal bit for bit */
#define KB_PROBE_CLOSE 6  /* floats an item, to be equal within a few ulp */

KB_FN void kb_probe_random(kb_u32 i, KB_GLOBAL const kb_u32* table, KB_GLOBAL kb_u32* out) {
  const KbPhilox4 counter = {i, i * 7u, i * i, 3u};
  const KbPhiloxKey key = {i ^ 0xa5a5a5a5u, ~i};
  const KbPhilox4 r = kb_philox4x32(counter, key);
  out[0] = r.x;
  out[1] = r.y;
  out[2] = r.z;
  out[3] = r.w;
  const kb_u32x4 s = kb_sobol_block(table, kb_reverse_bits(i), i * 3u, i * 5u, i & 31u);
  out[4] = kb_u32x4_x(s);
  out[5] = kb_u32x4_y(s);
  out[6] = kb_u32x4_z(s);
  out[7] = kb_u32x4_w(s);
  const kb_u64 seed = 0x123456789abcdeful;
  const KbSamplerKey independent =
      kb_sampler_key(KB_SAMPLER_INDEPENDENT, seed, kb_sampler_root(seed), i, 5u, 1u, 2u, table);
  const KbSamplerKey sobol =
      kb_sampler_key(KB_SAMPLER_SOBOL, seed, kb_sampler_root(seed), i, 5u, 1u, i >> 3, table);
  const KbFloat4 a = kb_sampler_block(&independent, i & 7u), b = kb_sampler_block(&sobol, i & 7u);
  out[8] = kb_as_u32(a.x);
  out[9] = kb_as_u32(a.w);
  out[10] = kb_as_u32(b.x);
  out[11] = kb_as_u32(b.w);
  out[12] = kb_as_u32(kb_path_mu(KB_SAMPLER_INDEPENDENT, 99ul, i, 5u, 1u, 2u));
  out[13] = kb_as_u32(kb_path_mu(KB_SAMPLER_SOBOL, 99ul, i, 5u, 1u, 2u));
  out[14] = kb_as_u32(kb_shared_mu(99ul, 3u, i, i * 5u, 7u));
  out[15] = kb_as_u32(kb_degrade_sample(99ul, i, 5u, 2u));
}

/* Only + - * / and square roots. */
KB_FN void kb_probe_arithmetic(KbFloat4 u, KB_GLOBAL kb_u32* out) {
  const KbFloat2 t = kb_triangle_uniform(u.x, u.y);
  const KbFresnel f = kb_fresnel_dielectric(2.0f * u.x - 1.0f, 0.5f + 2.0f * u.y);
  out[0] = kb_as_u32(t.x);
  out[1] = kb_as_u32(t.y);
  out[2] = kb_as_u32(f.reflectance);
  out[3] = kb_as_u32(f.cos_t);
  out[4] = kb_as_u32(f.eta_it);
  out[5] = kb_as_u32(kb_sigmoid(8.0f * u.z - 4.0f));
}

/* With sin, cos, log. */
KB_FN void kb_probe_functions(KbFloat4 u, KB_GLOBAL float* out) {
  const KbFloat2 p = kb_disk_concentric(u.x, u.y);
  const KbFloat3 w = kb_sphere_uniform(u.x, u.y);
  out[0] = p.x;
  out[1] = p.y;
  out[2] = w.x;
  out[3] = w.y;
  out[4] = w.z;
  out[5] = kb_erf_inv(2.0f * u.y - 1.0f);
}

/* table: kb_sobol_table */
KB_FN void kb_probe_item(kb_u32 i, KB_GLOBAL const kb_u32* table, KB_GLOBAL kb_u32* exact,
                         KB_GLOBAL float* close) {
  const KbFloat4 u = kb_philox_floats(42ul, i, 0u, 0u, 0u);
  kb_probe_random(i, table, exact + i * KB_PROBE_EXACT);
  kb_probe_arithmetic(u, exact + i * KB_PROBE_EXACT + 16);
  kb_probe_functions(u, close + i * KB_PROBE_CLOSE);
}

#endif
