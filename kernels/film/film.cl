// Film kernels (build macro KB_FILM_TRANSPOSED, see film.clh).
//
//   kernel        work-items
//   film_clear    packing_pixels * film columns, at least packing_pixels: the first pixels become 0
//   film_close    packing_pixels * film columns
//   film_pack     packing_pixels * (K + D)
//   film_unpack   the same
//   film_finish   the same; packed: means
//
// means[pixel][K + D]: means over the valid samples of film pixels first_pixel .. first_pixel + pixels - 1, in film
// units (times channel_scale or derived scale: W m^-2 sr^-1); 0 where there is no sample.
// film_close adds the sums of chunks of samples, which are complete and become 0, to the film. film_pack and film_unpack
// copy an array of the film (sum, compensation or open) to and from packed[pixel][K + D].
#undef KB_WIDTH
#define KB_WIDTH 1
#include "film/film.clh"
#include "shared/spectra_layout.h"

__kernel void film_clear(KB_FILM_PARAMS) {
  const size_t i = get_global_id(0);
  if (i < packing_pixels) film_counts[i] = 0u;
  if (i >= (size_t)packing_pixels * packing_layout->film_columns) return;
  film_sum[i] = 0.0f;
  film_compensation[i] = 0.0f;
}

__kernel void film_close(KB_FILM_PARAMS) {
  const size_t i = get_global_id(0);
  if (i >= (size_t)packing_pixels * packing_layout->film_columns) return;
  add_scalar(film_sum + i, film_compensation + i, packing_open[i]);
  packing_open[i] = 0.0f;
}

/* Where value i of packed[pixel][K + D] stands in the film. */
static inline size_t place_of_packed(__constant KbSpectraLayout* layout, const Film* film, size_t i) {
  const kb_u32 values = layout->channels + layout->derived, value = (kb_u32)(i % values);
  const kb_u32 column = value < layout->channels ? value : layout->stride + (value - layout->channels);
  return film_place(film, film->first + i / values, column);
}

__kernel void film_pack(KB_FILM_PARAMS) {
  const size_t i = get_global_id(0);
  if (i >= (size_t)packing_pixels * (packing_layout->channels + packing_layout->derived)) return;
  KB_FILM_INIT(film, packing_layout->film_columns);
  packing_packed[i] = packing_values[place_of_packed(packing_layout, &film, i)];
}

__kernel void film_unpack(KB_FILM_PARAMS) {
  const size_t i = get_global_id(0);
  if (i >= (size_t)packing_pixels * (packing_layout->channels + packing_layout->derived)) return;
  KB_FILM_INIT(film, packing_layout->film_columns);
  packing_values[place_of_packed(packing_layout, &film, i)] = packing_packed[i];
}

__kernel void film_finish(KB_FILM_PARAMS) {
  const size_t i = get_global_id(0);
  const kb_u32 values = packing_layout->channels + packing_layout->derived;
  if (i >= (size_t)packing_pixels * values) return;
  KB_FILM_INIT(film, packing_layout->film_columns);
  const kb_u32 count = film_counts[film_first + i / values];
  const size_t place = place_of_packed(packing_layout, &film, i);
  packing_packed[i] = count > 0u ? (film_sum[place] + film_compensation[place]) / (float)count : 0.0f;
}
