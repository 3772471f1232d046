// Deferred evaluation of a round's saved paths (paper, section 5); build macros: path_spectra.clh, film.clh.
//
//   kernel       arguments                             work-items
//   dpept_batch  EVALUATION, saved, FILM, partial      groups * local size, any number of groups (a group takes the
//                                                      pixels group, group + groups, ...); local size: any; what is
//                                                      worth while is work_items(K) = ceil(K / (KB_WIDTH KB_VECTORS))
//   dpept_path   EVALUATION, saved, FILM               round pixels; a work-item evaluates the paths of one pixel
//   derived_add  layout, FILM, partial, pixels, parts  pixels * D, after dpept_batch; only if there are derived channels
//
//   EVALUATION (13): layout, rows, tables, material_rows, cover, cover_breaks, materials, textures, texels, round,
//                    round_pixels, arena, chunk_next. `rows` is `dense` of resample_rows, with KB_PER_PATH=1 `nodes`.
//   FILM (5):        sum, compensation, counts, film_pixels, film_first (the film pixel of the round's pixel 0)
//   saved:           KbSavedPath by job
//   partial:         [round pixel][work-item of the group][D] floats, parts = local size of dpept_batch; not touched if
//                    D = 0
//
// Both methods add the paths of a pixel in the order of their samples, without atomic operations: the same bits each
// time. A sample counts for its pixel unless it is KB_SAVED_INVALID.
#include "evaluate.clh"
#include "film.clh"
#include "evaluate_pixel.clh"

__kernel void dpept_batch(KB_EVALUATION_PARAMS, __global const KbSavedPath* restrict saved, KB_FILM_PARAMS,
                          __global float* restrict partial) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, arg_layout->film_columns);
  const kb_u32 items = (kb_u32)get_local_size(0), item = (kb_u32)get_local_id(0);
  for (kb_u32 pixel = (kb_u32)get_group_id(0); pixel < arg_round->pixels; pixel += (kb_u32)get_num_groups(0)) {
    float derived[KB_DERIVED + 1];
    evaluate_pixel(&evaluation, saved, &film, pixel, item, items, derived);
#if KB_DERIVED
    for (kb_u32 d = 0u; d < KB_DERIVED; ++d)
      partial[((size_t)pixel * items + item) * KB_DERIVED + d] = derived[d];
#else
    (void)partial;
#endif
    if (item == 0u) arg_film_counts[film_first + pixel] += valid_samples(&evaluation, saved, pixel);
  }
}

__kernel void dpept_path(KB_EVALUATION_PARAMS, __global const KbSavedPath* restrict saved, KB_FILM_PARAMS) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, arg_layout->film_columns);
  const kb_u32 pixel = (kb_u32)get_global_id(0);
  if (pixel >= arg_round->pixels) return;
  float derived[KB_DERIVED + 1];
  evaluate_pixel(&evaluation, saved, &film, pixel, 0u, 1u, derived);
#if KB_DERIVED
  for (kb_u32 d = 0u; d < KB_DERIVED; ++d) add_to_column(&film, pixel, arg_layout->stride + d, derived[d]);
#endif
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
