// Replicates that are complete (build macros KB_WIDTH: channels of a work-item, 1 where the film is transposed; KB_FILM_TRANSPOSED).
//
//   kernel          work-items
//   replicate_fold  (end_part - first_part) * film columns / KB_WIDTH
//
// replicate_fold moves the film's sums, those of one replicate, into the moments over replicates, with the operations and the roundings of
// the host's film (src/film/moment_kernels.cpp), and leaves sums of 0. sums + lost are the sums of the replicate's samples over the
// pixels of a part, within 2^-40 of the sum of their magnitudes, unless they are so small that their rounding errors underflow.
#include "film/film.clh"
#include "shared/spectra_layout.h"

/* The film's mean of a pixel's samples; its sums become 0. */
static inline Reals take_mean(const Film* film, size_t place, float count) {
  const Reals zero = (Reals)(0.0f);
  const Reals mean = (load_reals(film->sum + place) + load_reals(film->compensation + place)) / count;
  store_reals(film->sum + place, zero);
  store_reals(film->compensation + place, zero);
  return mean;
}

__kernel void replicate_fold(KB_REPLICATES_PARAMS) {
  const kb_u32 columns = replicates_layout->film_columns, vectors = columns / KB_WIDTH;
  const size_t i = get_global_id(0);
  if (i >= (size_t)(replicates_end_part - replicates_first_part) * vectors) return;
  KB_FILM_INIT(film, columns);
  const kb_u32 part = replicates_first_part + (kb_u32)(i / vectors), column = (kb_u32)(i % vectors) * KB_WIDTH;
  const kb_u32 first = replicates_parts[part].first, end = first + replicates_parts[part].count;
  Reals sum = (Reals)(0.0f), lost = (Reals)(0.0f);
  for (kb_u32 pixel = first; pixel < end; ++pixel) {
    const kb_u32 samples = film_counts[pixel];
    if (samples == 0u) continue; /* its sums are 0 */
    const float count = (float)samples;
    const size_t place = film_place(&film, pixel, column);
    const Reals x = take_mean(&film, place, count);
    const KbFloat2 weight = replicates_weights[pixel];
    const Reals before = load_reals(replicates_mean + place), difference = x - before;
    store_reals(replicates_mean + place, before + weight.x * difference);
    if (replicates_variance) {
      const Reals square = weight.y * difference * difference;
      store_reals(replicates_m2 + place, load_reals(replicates_m2 + place) + square);
    }
    const Reals product = count * x, after = sum + product, added = after - sum;
    lost += (sum - (after - added)) + (product - added) + fma((Reals)(count), x, -product);
    sum = after;
  }
  const size_t place = (size_t)part * columns + column;
  store_reals(replicates_sums + place, sum);
  store_reals(replicates_lost + place, lost);
}
