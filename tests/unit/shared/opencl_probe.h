// What opencl_device_test.cpp computes on host and device: one item's results, with the same code.
#ifndef KILOBAND_TESTS_OPENCL_PROBE_H
#define KILOBAND_TESTS_OPENCL_PROBE_H

#include "shared/sampler.h"
#include "shared/spectrum_table.h"
#include "shared/warp.h"

#define KB_PROBE_EXACT 36 /* words an item, to be equal bit for bit */
#define KB_PROBE_CLOSE 31 /* floats an item, to be equal within a few ulp */

KB_FN void kb_probe_random(kb_u32 i, KB_GLOBAL kb_u32* out) {
  const KbPhilox4 counter = {i, i * 7u, i * i, 3u};
  const KbPhiloxKey key = {i ^ 0xa5a5a5a5u, ~i};
  const KbPhilox4 r = kb_philox4x32(counter, key);
  out[0] = r.x;
  out[1] = r.y;
  out[2] = r.z;
  out[3] = r.w;
  const kb_u32x4 s = kb_sobol_block(kb_reverse_bits(i), i * 3u, i * 5u, i & 31u);
  out[4] = kb_u32x4_x(s);
  out[5] = kb_u32x4_y(s);
  out[6] = kb_u32x4_z(s);
  out[7] = kb_u32x4_w(s);
  const KbFloat4 a = kb_sample_block(KB_SAMPLER_INDEPENDENT, 0x123456789abcdeful, i, 5u, 1u, 2u, i & 7u);
  const KbFloat4 b = kb_sample_block(KB_SAMPLER_SOBOL, 0x123456789abcdeful, i, 5u, 1u, i >> 3, i & 7u);
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
KB_FN void kb_probe_arithmetic(KbFloat4 u, KB_GLOBAL const float* table_values, KB_GLOBAL kb_u32* out) {
  const KbFloat2 t = kb_triangle_uniform(u.x, u.y);
  const KbFresnel f = kb_fresnel_dielectric(2.0f * u.x - 1.0f, 0.5f + 2.0f * u.y);
  const KbFresnelConductor c = kb_fresnel_conductor_both(u.x, 3.0f * u.y, 8.0f * u.z);
  const KbFloat3 m = kb_normalize3(kb_float3(u.x - 0.5f, u.y - 0.5f, u.z + 0.01f));
  const KbFloat3 v = kb_normalize3(kb_float3(u.y - 0.5f, u.z - 0.5f, u.w + 0.01f));
  const KbSpectrumTable table = {400.0f, 0.1f, 1u, 5u, u.w > 0.5f, 0u};
  const KbFloat4 texel = {1e-5f * u.x, -0.01f * u.y, u.z, 2.0f};
  out[0] = kb_as_u32(t.x);
  out[1] = kb_as_u32(t.y);
  out[2] = kb_as_u32(kb_filter_tent(u.x, 1.5f));
  out[3] = kb_as_u32(f.reflectance);
  out[4] = kb_as_u32(f.cos_t);
  out[5] = kb_as_u32(f.eta_it);
  out[6] = kb_as_u32(c.reflectance);
  out[7] = kb_as_u32(c.absorptance);
  out[8] = kb_as_u32(m.x);
  out[9] = kb_as_u32(m.z);
  out[10] = kb_as_u32(kb_microfacet_d(KB_MICROFACET_GGX, 0.1f + u.x, 0.1f + u.y, m));
  out[11] = kb_as_u32(kb_microfacet_g1(KB_MICROFACET_GGX, 0.1f + u.x, 0.1f + u.y, v, m));
  out[12] = kb_as_u32(kb_microfacet_visible_pdf(KB_MICROFACET_GGX, 0.1f + u.x, 0.1f + u.y, v, m));
  out[13] = kb_as_u32(kb_power_heuristic(u.x, u.y));
  out[14] = kb_as_u32(kb_one_minus_cos(u.x));
  out[15] = kb_as_u32(kb_cone_uniform_pdf(u.x + 0.01f));
  out[16] = kb_as_u32(kb_table_value(table_values, table, 380.0f + 80.0f * u.x));
  out[17] = kb_as_u32(kb_texel_value(texel, 300.0f + 600.0f * u.w));
  out[18] = kb_as_u32(kb_filter_box(u.z, 0.5f));
  out[19] = kb_as_u32(kb_hemisphere_cosine_pdf(2.0f * u.x - 1.0f));
}

KB_FN void kb_probe_put3(KbFloat3 v, KB_GLOBAL float* out) {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

/* With sin, cos, exp, log, erf. Points of a disk stay off its rim, where lifting them onto the sphere,
   sqrt(1 - r^2), turns an ulp of r into many. The values from 24 on come out of iterations or steep tails. */
KB_FN void kb_probe_functions(KbFloat4 u, KB_GLOBAL float* out) {
  const KbFloat2 p = kb_disk_concentric(u.x, u.y);
  const KbFloat3 m = kb_normalize3(kb_float3(u.x - 0.5f, u.y - 0.5f, u.z + 0.5f));
  const KbFloat3 v = kb_normalize3(kb_float3(u.y - 0.5f, u.z - 0.5f, u.w + 0.05f));
  out[0] = p.x;
  out[1] = p.y;
  kb_probe_put3(kb_hemisphere_cosine(0.05f + 0.9f * u.x, 0.05f + 0.9f * u.y), out + 2);
  kb_probe_put3(kb_sphere_uniform(u.x, u.y), out + 5);
  kb_probe_put3(kb_cone_uniform(u.x, u.y, 0.01f), out + 8);
  kb_probe_put3(kb_microfacet_sample_all(KB_MICROFACET_GGX, 0.3f, 0.6f, u.x, u.y), out + 11);
  kb_probe_put3(kb_microfacet_sample_all(KB_MICROFACET_BECKMANN, 0.3f, 0.6f, u.x, u.y), out + 14);
  kb_probe_put3(kb_microfacet_sample_visible(KB_MICROFACET_GGX, 0.3f, 0.6f, v, 0.9f * u.x, u.y), out + 17);
  out[20] = kb_microfacet_g1(KB_MICROFACET_BECKMANN, 0.1f + u.x, 0.1f + u.y, v, m);
  out[21] = kb_filter_gaussian(u.x, 0.5f, 2.0f);
  out[22] = kb_erf_inv(2.0f * u.y - 1.0f);
  out[23] = kb_filter_gaussian(u.z, 1.0f, 1.0f);
  kb_probe_put3(kb_microfacet_sample_visible(KB_MICROFACET_BECKMANN, 0.3f, 0.6f, v, u.x, u.y), out + 24);
  kb_probe_put3(kb_microfacet_sample_visible(KB_MICROFACET_BECKMANN, 1.0f, 0.1f, m, u.z, u.w), out + 27);
  out[30] = kb_microfacet_d(KB_MICROFACET_BECKMANN, 0.3f + u.x, 0.3f + u.y, m);
}

KB_FN void kb_probe_item(kb_u32 i, KB_GLOBAL const float* table_values, KB_GLOBAL kb_u32* exact,
                         KB_GLOBAL float* close) {
  const KbFloat4 u = kb_philox_floats(42ul, i, 0u, 0u, 0u);
  kb_probe_random(i, exact + i * KB_PROBE_EXACT);
  kb_probe_arithmetic(u, table_values, exact + i * KB_PROBE_EXACT + 16);
  kb_probe_functions(u, close + i * KB_PROBE_CLOSE);
}

#endif
