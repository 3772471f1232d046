// The straightforward method (DPEPT paper, section 4): throughput tau and radiance L of every channel of every
// path in flight live in global memory and are updated at each bounce. Build macros: path_spectra.clh.
//
//   kernel      work-items
//   pt_update   groups * local size, any number of groups, which share the queue evenly
//   pt_derived  length of the queue * D, after pt_update; only if there are derived channels
//
// Padded pixels of the round have no film. evaluation_parts: local size of pt_update. Runs once per bounce after shadow rays, over the
// slots of the queue: the vertices of the bounce are states[slot].length entries of the arena from chunk `slot` on;
// KB_PATH_FRESH: tau = 1, L = 0 before them; KB_PATH_ENDED: L goes to the film of the path's pixel (not if
// KB_PATH_INVALID, then the sample does not count).
#include "evaluate/evaluate.clh"
#include "film/film.clh"

static inline void load_batch(Batch* batch, __global const float* tau, __global const float* radiance) {
#pragma unroll
  for (kb_u32 i = 0u; i < KB_VECTORS; ++i) {
    if (!is_kept(batch, i)) continue; /* another work-item may be writing it */
    batch->tau[i] = load_reals(tau + batch->k[i]);
    batch->radiance[i] = load_reals(radiance + batch->k[i]);
  }
}

static inline void store_batch(const Batch* batch, __global float* tau, __global float* radiance) {
#pragma unroll
  for (kb_u32 i = 0u; i < KB_VECTORS; ++i) {
    if (!is_kept(batch, i)) continue;
    store_reals(tau + batch->k[i], batch->tau[i]);
    store_reals(radiance + batch->k[i], batch->radiance[i]);
  }
}

static inline void add_batch_to_film(const Film* film, kb_u32 pixel, const Batch* batch) {
#pragma unroll
  for (kb_u32 i = 0u; i < KB_VECTORS; ++i)
    if (is_kept(batch, i)) add_to_film(film, pixel, batch->k[i], batch->radiance[i]);
}

/* Bytes per channel: 16 for a bounce in between, 8 for a first one, 8 + 16 for a last one (the film's sums). */
static inline void update_slot(const Evaluation* e, const Film* film, const KbPathState* state, kb_u32 slot,
                               __global float* tau, __global float* radiance, kb_u32 item, kb_u32 items,
                               float* derived) {
  const kb_u32 pixel = state->job % e->round->padded_pixels;
  const PathSpectra spectra = path_spectra(e, pixel, state->job / e->round->padded_pixels);
  const kb_u32 vectors = vector_count(e);
  const bool fresh = state->flags & KB_PATH_FRESH, ended = state->flags & KB_PATH_ENDED;
  Batch batch;
  derived_clear(derived);
  for (kb_u32 first = item; first < vectors; first += items * KB_VECTORS) {
    place_batch(&batch, first, items, vectors);
    start_batch(&batch);
    if (!fresh) load_batch(&batch, tau + (size_t)slot * spectra.stride, radiance + (size_t)slot * spectra.stride);
    run_vertices(&spectra, e->arena, slot * KB_CHUNK_ENTRIES, state->length, &batch);
    if (!ended) {
      store_batch(&batch, tau + (size_t)slot * spectra.stride, radiance + (size_t)slot * spectra.stride);
    } else if (!(state->flags & KB_PATH_INVALID)) {
      add_batch_to_film(film, pixel, &batch);
      derived_of_path(&spectra, &batch, derived);
    }
  }
}

__kernel void pt_update(KB_EVALUATION_PARAMS) {
  KB_EVALUATION_INIT(evaluation);
  KB_FILM_INIT(film, spectra_layout->film_columns);
  const kb_u32 items = (kb_u32)get_local_size(0), item = (kb_u32)get_local_id(0);
  const kb_u32 count = queue_length[0];
  const kb_u32 share = (count + (kb_u32)get_num_groups(0) - 1u) / (kb_u32)get_num_groups(0);
  const kb_u32 begin = share * (kb_u32)get_group_id(0);
  for (kb_u32 place = begin; place < min(begin + share, count); ++place) {
    const kb_u32 slot = queue_slots[place];
    const KbPathState state = pool_states[slot];
    if (state.flags & KB_PATH_FINISHED) continue;
    if (state.length == 0u && !(state.flags & (KB_PATH_FRESH | KB_PATH_ENDED))) continue;
    float derived[KB_DERIVED + 1];
    update_slot(&evaluation, &film, &state, slot, evaluation_tau, evaluation_radiance, item, items, derived);
#if KB_DERIVED
    __global float* part = evaluation_partial + ((size_t)slot * items + item) * KB_DERIVED;
    for (kb_u32 d = 0u; d < KB_DERIVED; ++d) part[d] = derived[d];
#endif
    if (item == 0u && (state.flags & (KB_PATH_ENDED | KB_PATH_INVALID)) == KB_PATH_ENDED)
      ++film_counts[film_first + state.job % pool_round->padded_pixels];
  }
}

/* The work-items' parts of derived channels of paths that ended, in order. */
__kernel void pt_derived(KB_EVALUATION_PARAMS) {
  const kb_u32 derived = spectra_layout->derived, parts = evaluation_parts;
  const size_t i = get_global_id(0);
  if (i >= (size_t)queue_length[0] * derived) return;
  const kb_u32 slot = queue_slots[i / derived], d = (kb_u32)(i % derived);
  const KbPathState state = pool_states[slot];
  if ((state.flags & (KB_PATH_FINISHED | KB_PATH_ENDED | KB_PATH_INVALID)) != KB_PATH_ENDED) return;
  KB_FILM_INIT(film, spectra_layout->film_columns);
  float sum = 0.0f;
  for (kb_u32 part = 0u; part < parts; ++part) sum += evaluation_partial[((size_t)slot * parts + part) * derived + d];
  add_to_column(&film, state.job % pool_round->padded_pixels, spectra_layout->stride + d, sum);
}
