// Deferred evaluation of a round's saved paths (DPEPT paper, section 5); build macros: path_spectra.clh,
// film.clh, and KB_PIXELS (evaluate_tile.clh; 1 for dpept_path).
//
//   kernel       work-items
//   dpept_batch  groups * local size; groups: ceil(round pixels / KB_PIXELS), or fewer; local size: any, worth while up
//                to ceil(K / (KB_WIDTH KB_VECTORS)); on CPU devices 1
//   dpept_path   round pixels; a work-item evaluates the paths of one pixel
//   derived_add  round pixels * D, after dpept_batch; only if there are derived channels
//
// evaluation_partial is not touched if D = 0; evaluation_parts: the local size of dpept_batch.
//
// Both methods add the paths of a pixel in the order of their samples, without atomic operations: the same bits each
// time. A sample counts for its pixel unless it is KB_SAVED_INVALID.
#include "evaluate/evaluate.clh"
#include "film/film.clh"
#include "evaluate/evaluate_tile.clh"
#include "evaluate/stage.clh"

/* Notes the work-item's part of the derived channels of a tile; `more` adds to what is there. */
static inline void keep_derived(__global float* partial, const TileSums* sums, kb_u32 first_pixel, kb_u32 end_pixel,
                                bool more) {
#if KB_DERIVED
  const kb_u32 items = (kb_u32)get_local_size(0), item = (kb_u32)get_local_id(0);
  for (kb_u32 pixel = first_pixel; pixel < end_pixel; ++pixel) {
    __global float* part = partial + ((size_t)pixel * items + item) * KB_DERIVED;
    const float* sum = sums->derived + (pixel - first_pixel) % KB_PIXELS * KB_DERIVED;
    for (kb_u32 d = 0u; d < KB_DERIVED; ++d) part[d] = more ? part[d] + sum[d] : sum[d];
  }
#else
  (void)partial, (void)sums, (void)first_pixel, (void)end_pixel, (void)more;
#endif
}

__kernel void dpept_batch(KB_EVALUATION_PARAMS) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, spectra_layout->film_columns);
  const kb_u32 items = (kb_u32)get_local_size(0), item = (kb_u32)get_local_id(0), pixels = pool_round->pixels;
  const kb_u32 vectors = vector_count(&evaluation);
#if KB_STAGED
  __local uint4 entries[2 * KB_STAGE_ENTRIES];
  __local PathCursor cursors[KB_SAMPLES_IN_REGISTERS];
  __local kb_u32 staged[KB_SAMPLES_IN_REGISTERS];
  const Stage stage = {entries, cursors, staged};
#endif
  TileSums sums;
  for (kb_u32 d = 0u; d < KB_PIXELS * KB_DERIVED; ++d) sums.derived[d] = 0.0f;
  for (kb_u32 pixel = (kb_u32)get_group_id(0) * KB_PIXELS; pixel < pixels;
       pixel += (kb_u32)get_num_groups(0) * KB_PIXELS) {
    const kb_u32 end = min(pixel + KB_PIXELS, pixels);
#if KB_STAGED
    /* Work-items without channels come along: all meet at barriers. */
    for (kb_u32 first = 0u; first < vectors; first += items * KB_VECTORS) {
      evaluate_staged(&evaluation, pool_saved, &film, pixel, first + item, items, &stage, &sums);
      keep_derived(evaluation_partial, &sums, pixel, end, first != 0u);
    }
#else
    if (item >= vectors) keep_derived(evaluation_partial, &sums, pixel, end, false); /* a work-item without channels */
    for (kb_u32 first = item; first < vectors; first += items * KB_VECTORS) {
      evaluate_tile(&evaluation, pool_saved, &film, pixel, end, first, items, &sums);
      keep_derived(evaluation_partial, &sums, pixel, end, first != item);
    }
#endif
    for (kb_u32 p = pixel; p < end && item == 0u; ++p)
      film_counts[film_first + p] += valid_samples(&evaluation, pool_saved, p);
  }
}

#if !KB_STAGED
__kernel void dpept_path(KB_EVALUATION_PARAMS) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, spectra_layout->film_columns);
  const kb_u32 pixel = (kb_u32)get_global_id(0);
  if (pixel >= pool_round->pixels) return;
  TileSums sums;
  for (kb_u32 first = 0u; first < vector_count(&evaluation); first += KB_VECTORS) {
    evaluate_tile(&evaluation, pool_saved, &film, pixel, pixel + 1u, first, 1u, &sums);
#if KB_DERIVED
    for (kb_u32 d = 0u; d < KB_DERIVED; ++d) add_to_column(&film, pixel, spectra_layout->stride + d, sums.derived[d]);
#endif
  }
  film_counts[film_first + pixel] += valid_samples(&evaluation, pool_saved, pixel);
}
#endif

/* The work-items' parts of derived channels, in order. */
__kernel void derived_add(KB_EVALUATION_PARAMS) {
  const kb_u32 derived = spectra_layout->derived, parts = evaluation_parts;
  const size_t i = get_global_id(0);
  if (i >= (size_t)pool_round->pixels * derived) return;
  KB_FILM_INIT(film, spectra_layout->film_columns);
  const kb_u32 pixel = (kb_u32)(i / derived), d = (kb_u32)(i % derived);
  float sum = 0.0f;
  for (kb_u32 part = 0u; part < parts; ++part) sum += evaluation_partial[((size_t)pixel * parts + part) * derived + d];
  add_to_column(&film, pixel, spectra_layout->stride + d, sum);
}
