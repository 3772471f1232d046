// Deferred evaluation of a round's saved paths (DPEPT paper, section 5); build macros: path_spectra.clh,
// film.clh, and KB_PIXELS (evaluate_tile.clh; 1 for dpept_path).
//
//   kernel       work-items
//   dpept_batch  groups * local size; groups: ceil(round pixels / KB_PIXELS), or fewer. Local size: 1 on CPU devices; with the stage
//                KB_PIXELS * items, any number, worth while up to ceil(K / (KB_WIDTH KB_VECTORS))
//   dpept_path   round pixels; a work-item evaluates the paths of one pixel
//   derived_add  round pixels * D, after dpept_batch; only if there are derived channels
//
// evaluation_partial is not touched if D = 0; evaluation_parts: the work-items of dpept_batch that share a pixel.
//
// Both methods add the paths of a pixel in the order of their samples, without atomic operations: the same bits each
// time. A sample counts for its pixel unless it is KB_SAVED_INVALID.
#include "evaluate/evaluate.clh"
#include "film/film.clh"
#include "evaluate/evaluate_tile.clh"
#include "evaluate/stage.clh"

/* Notes a work-item's part of the derived channels of a tile, one of `parts`; `more` adds to what is there. */
static inline void keep_derived(__global float* partial, const TileSums* sums, kb_u32 first_pixel, kb_u32 end_pixel,
                                kb_u32 item, kb_u32 parts, bool more) {
#if KB_DERIVED
  for (kb_u32 pixel = first_pixel; pixel < end_pixel; ++pixel) {
    __global float* part = partial + ((size_t)pixel * parts + item) * KB_DERIVED;
    const float* sum = sums->derived + (pixel - first_pixel) % KB_TILE * KB_DERIVED;
    for (kb_u32 d = 0u; d < KB_DERIVED; ++d) part[d] = more ? part[d] + sum[d] : sum[d];
  }
#else
  (void)partial, (void)sums, (void)first_pixel, (void)end_pixel, (void)item, (void)parts, (void)more;
#endif
}

#if KB_STAGED
/* The group's work-items divide into KB_PIXELS parts, of a pixel each, and those into the channels. */
__kernel void dpept_batch(KB_EVALUATION_PARAMS) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, spectra_layout->film_columns);
  __local uint4 entries[KB_PIXELS * 2 * KB_STAGE_ENTRIES];
  __local PathCursor cursors[KB_PIXELS * KB_SAMPLES_IN_REGISTERS];
  __local uint2 staged[KB_PIXELS * KB_SAMPLES_IN_REGISTERS];
  __local kb_u32 samples_counted[KB_PIXELS], goes_on[2];
  const kb_u32 items = (kb_u32)get_local_size(0) / KB_PIXELS;
  const kb_u32 place = (kb_u32)get_local_id(0) / items, item = (kb_u32)get_local_id(0) % items;
  const Stage stage = {entries + place * 2u * KB_STAGE_ENTRIES,
                       cursors + place * KB_SAMPLES_IN_REGISTERS,
                       staged + place * KB_SAMPLES_IN_REGISTERS,
                       samples_counted + place,
                       goes_on,
                       item,
                       items};
  if (item == 0u) *stage.counted = 0u;
  barrier(CLK_LOCAL_MEM_FENCE);
  kb_u32 before = 0u;
  TileSums sums;
  for (kb_u32 d = 0u; d < KB_DERIVED; ++d) sums.derived[d] = 0.0f;
  for (kb_u32 first_pixel = (kb_u32)get_group_id(0) * KB_PIXELS; first_pixel < pool_round->pixels;
       first_pixel += (kb_u32)get_num_groups(0) * KB_PIXELS) {
    const kb_u32 pixel = first_pixel + place, end = min(pixel + 1u, pool_round->pixels); /* no pixel: end <= pixel */
    /* Work-items without channels come along, and those without a pixel: all meet at barriers. */
    for (kb_u32 first = 0u; first < vector_count(&evaluation); first += items * KB_VECTORS) {
      const kb_u32 counted = evaluate_staged(&evaluation, pool_saved, &film, pixel, end, first + item, &stage, &sums);
      if (pixel < end && item == 0u && first == 0u) film_counts[film_first + pixel] += counted - before;
      before = counted;
      keep_derived(evaluation_partial, &sums, pixel, end, item, items, first != 0u);
    }
  }
}
#else
__kernel void dpept_batch(KB_EVALUATION_PARAMS) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, spectra_layout->film_columns);
  const kb_u32 items = (kb_u32)get_local_size(0), item = (kb_u32)get_local_id(0), pixels = pool_round->pixels;
  const kb_u32 vectors = vector_count(&evaluation);
  TileSums sums;
  for (kb_u32 d = 0u; d < KB_PIXELS * KB_DERIVED; ++d) sums.derived[d] = 0.0f;
  for (kb_u32 pixel = (kb_u32)get_group_id(0) * KB_PIXELS; pixel < pixels;
       pixel += (kb_u32)get_num_groups(0) * KB_PIXELS) {
    const kb_u32 end = min(pixel + KB_PIXELS, pixels);
    if (item >= vectors) /* a work-item without channels */
      keep_derived(evaluation_partial, &sums, pixel, end, item, items, false);
    for (kb_u32 first = item; first < vectors; first += items * KB_VECTORS) {
      evaluate_tile(&evaluation, pool_saved, &film, pixel, end, first, items, &sums);
      keep_derived(evaluation_partial, &sums, pixel, end, item, items, first != item);
    }
    for (kb_u32 p = pixel; p < end && item == 0u; ++p)
      film_counts[film_first + p] += valid_samples(&evaluation, pool_saved, p);
  }
}

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
