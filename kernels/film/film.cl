// Film kernels (build macro KB_FILM_TRANSPOSED, see film.clh).
//
//   kernel        arguments                                                      work-items
//   film_clear    sum, compensation, counts, film_pixels, film_columns           film_pixels * film_columns, at least
//                                                                                film_pixels
//   film_close    sum, compensation, open, film_pixels, film_columns             film_pixels * film_columns
//   film_pack     layout, values, film_pixels, first_pixel, pixels, packed       pixels * (K + D)
//   film_unpack   the same                                                       pixels * (K + D)
//   film_finish   layout, sum, compensation, counts, film_pixels, first_pixel,   pixels * (K + D)
//                 pixels, means
//
// means[pixel][K + D]: means over the valid samples of film pixels first_pixel .. first_pixel + pixels - 1, in film
// units (times channel_scale or derived scale: W m^-2 sr^-1); 0 where there is no sample.
// film_close adds the sums of chunks of samples, which are complete and become 0, to the film. film_pack and film_unpack
// copy an array of the film (sum, compensation or open) to and from packed[pixel][K + D].
#undef KB_WIDTH
#define KB_WIDTH 1
#include "film/film.clh"
#include "shared/planted_faults.h"
#include "shared/spectra_layout.h"

__kernel void film_clear(__global float* restrict sum, __global float* restrict compensation,
                         __global kb_u32* restrict counts, kb_u32 film_pixels, kb_u32 film_columns) {
  const size_t i = get_global_id(0);
  if (i < film_pixels) counts[i] = 0u;
  if (i >= (size_t)film_pixels * film_columns) return;
  sum[i] = 0.0f;
  compensation[i] = 0.0f;
}

__kernel void film_close(__global float* restrict sum, __global float* restrict compensation,
                         __global float* restrict open, kb_u32 film_pixels, kb_u32 film_columns) {
  const size_t i = get_global_id(0);
  if (i >= (size_t)film_pixels * film_columns) return;
  add_scalar(sum + i, compensation + i, open[i]);
  open[i] = 0.0f;
}

/* Where value i of packed[pixel][K + D] stands in the film. */
static inline size_t place_of_packed(__global const KbSpectraLayout* layout, kb_u32 film_pixels, kb_u32 first_pixel,
                                     size_t i) {
  const kb_u32 values = layout->channels + layout->derived, value = (kb_u32)(i % values);
  const Film film = {0, 0, 0, film_pixels, 0u, layout->film_columns};
  const kb_u32 column = value < layout->channels ? value : layout->stride + (value - layout->channels);
  return film_place(&film, first_pixel + i / values, column);
}

__kernel void film_pack(__global const KbSpectraLayout* restrict layout, __global const float* restrict values,
                        kb_u32 film_pixels, kb_u32 first_pixel, kb_u32 pixels, __global float* restrict packed) {
  const size_t i = get_global_id(0);
  if (i >= (size_t)pixels * (layout->channels + layout->derived)) return;
  packed[i] = values[place_of_packed(layout, film_pixels, first_pixel, i)];
}

__kernel void film_unpack(__global const KbSpectraLayout* restrict layout, __global float* restrict values,
                          kb_u32 film_pixels, kb_u32 first_pixel, kb_u32 pixels,
                          __global const float* restrict packed) {
  const size_t i = get_global_id(0);
  if (i >= (size_t)pixels * (layout->channels + layout->derived)) return;
  values[place_of_packed(layout, film_pixels, first_pixel, i)] = packed[i];
}

__kernel void film_finish(__global const KbSpectraLayout* restrict layout, __global float* restrict sum,
                          __global float* restrict compensation, __global kb_u32* restrict counts, kb_u32 film_pixels,
                          kb_u32 first_pixel, kb_u32 pixels, __global float* restrict means) {
  const size_t i = get_global_id(0);
  const kb_u32 values = layout->channels + layout->derived;
  if (i >= (size_t)pixels * values) return;
  const Film film = {sum, compensation, counts, film_pixels, 0u, layout->film_columns};
  const kb_u32 value = (kb_u32)((i + KB_PLANTED(CHANNEL_SHIFT)) % values);
  const size_t pixel = first_pixel + i / values;
  const kb_u32 column = value < layout->channels ? value : layout->stride + (value - layout->channels);
  const size_t place = film_place(&film, pixel, column);
  const kb_u32 count = counts[pixel];
  means[i] = count > 0u ? (sum[place] + compensation[place]) / (float)count : 0.0f;
}
