// Deferred evaluation of a round's saved paths (DPEPT paper, section 5); build macros: path_spectra.clh,
// film.clh, and KB_PIXELS (evaluate_tile.clh; 1 for dpept_path).
//
//   kernel       arguments                             work-items
//   dpept_batch  EVALUATION, saved, FILM, partial      groups * local size; groups: ceil(round pixels / KB_PIXELS), or
//                                                      fewer; local size: any, worth while up to
//                                                      ceil(K / (KB_WIDTH KB_VECTORS)); on CPU devices 1
//   dpept_path   EVALUATION, saved, FILM               round pixels; a work-item evaluates the paths of one pixel
//   derived_add  layout, FILM, partial, pixels, parts  pixels * D, after dpept_batch; only if there are derived channels
//
//   EVALUATION (14): layout, rows, tables, material_rows, cover, cover_breaks, materials, textures, texels,
//                    texel_values, round, round_pixels, arena, chunk_next. `rows` is `dense` of resample_rows, with KB_PER_PATH=1 `nodes`.
//   FILM (5):        sum, compensation, counts, film_pixels, film_first (the film pixel of the round's pixel 0)
//   saved:           KbSavedPath by job
//   partial:         [round pixel][work-item of the group][D] floats, parts = local size of dpept_batch; not touched if
//                    D = 0
//
// Both methods add the paths of a pixel in the order of their samples, without atomic operations: the same bits each
// time. A sample counts for its pixel unless it is KB_SAVED_INVALID.
#include "evaluate/evaluate.clh"
#include "film/film.clh"
#include "evaluate/evaluate_tile.clh"

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

__kernel void dpept_batch(KB_EVALUATION_PARAMS, __global const KbSavedPath* restrict saved, KB_FILM_PARAMS,
                          __global float* restrict partial) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, arg_layout->film_columns);
  const kb_u32 items = (kb_u32)get_local_size(0), item = (kb_u32)get_local_id(0), pixels = arg_round->pixels;
  const kb_u32 vectors = vector_count(&evaluation);
  TileSums sums;
  for (kb_u32 d = 0u; d < KB_PIXELS * KB_DERIVED; ++d) sums.derived[d] = 0.0f;
  for (kb_u32 pixel = (kb_u32)get_group_id(0) * KB_PIXELS; pixel < pixels;
       pixel += (kb_u32)get_num_groups(0) * KB_PIXELS) {
    const kb_u32 end = min(pixel + KB_PIXELS, pixels);
    if (item >= vectors) keep_derived(partial, &sums, pixel, end, false); /* a work-item without channels */
    for (kb_u32 first = item; first < vectors; first += items * KB_VECTORS) {
      evaluate_tile(&evaluation, saved, &film, pixel, end, first, items, &sums);
      keep_derived(partial, &sums, pixel, end, first != item);
    }
    for (kb_u32 p = pixel; p < end && item == 0u; ++p)
      arg_film_counts[film_first + p] += valid_samples(&evaluation, saved, p);
  }
}

__kernel void dpept_path(KB_EVALUATION_PARAMS, __global const KbSavedPath* restrict saved, KB_FILM_PARAMS) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, arg_layout->film_columns);
  const kb_u32 pixel = (kb_u32)get_global_id(0);
  if (pixel >= arg_round->pixels) return;
  TileSums sums;
  for (kb_u32 first = 0u; first < vector_count(&evaluation); first += KB_VECTORS) {
    evaluate_tile(&evaluation, saved, &film, pixel, pixel + 1u, first, 1u, &sums);
#if KB_DERIVED
    for (kb_u32 d = 0u; d < KB_DERIVED; ++d) add_to_column(&film, pixel, arg_layout->stride + d, sums.derived[d]);
#endif
  }
  arg_film_counts[film_first + pixel] += valid_samples(&evaluation, saved, pixel);
}

/* The work-items' parts of derived channels, in order. */
__kernel void derived_add(__global const KbSpectraLayout* restrict layout, KB_FILM_PARAMS,
                          __global const float* restrict partial, kb_u32 pixels, kb_u32 parts) {
  const size_t i = get_global_id(0);
  if (i >= (size_t)pixels * layout->derived) return;
  KB_FILM_INIT(film, layout->film_columns);
  const kb_u32 pixel = (kb_u32)(i / layout->derived), d = (kb_u32)(i % layout->derived);
  float sum = 0.0f;
  for (kb_u32 part = 0u; part < parts; ++part) sum += partial[((size_t)pixel * parts + part) * layout->derived + d];
  add_to_column(&film, pixel, layout->stride + d, sum);
}
