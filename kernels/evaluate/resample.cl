// Dense spectra of shared wavelengths (build macros KB_WIDTH, see path_spectra.clh).
//
//   kernel         arguments                                                     work-items
//   resample_rows  layout, nodes, tables, cover, cover_breaks, shared_mu,        table_count * rows * stride / KB_WIDTH
//                  table_count, dense
//
// dense[table][row][stride]: every row of KbSpectraLayout at mu = shared_mu[table]; tables are numbered
// block * samples + sample of the round, as shared_mu. Derived channels' rows are divided by the cover.
#include "evaluate/path_spectra.clh"

__kernel void resample_rows(__global const KbSpectraLayout* restrict layout, __global const float* restrict nodes,
                            __global const KbChannelTable* restrict tables, __global const KbCover* restrict cover,
                            __global const KbCoverBreak* restrict cover_breaks,
                            __global const float* restrict shared_mu, kb_u32 table_count,
                            __global float* restrict dense) {
  const kb_u32 vectors = layout->stride / KB_WIDTH;
  const size_t i = get_global_id(0);
  if (i >= (size_t)table_count * layout->rows * vectors) return;
  const kb_u32 k = (kb_u32)(i % vectors) * KB_WIDTH;
  const kb_u32 row = (kb_u32)(i / vectors % layout->rows);
  const float mu = shared_mu[i / vectors / layout->rows];
#if KB_HAS_GAS
  if (tables[row].cells == 0u) {
    store_reals(dense + i * KB_WIDTH, line_values(nodes, tables[row].first, layout->channels, k, mu));
    return;
  }
#endif
  Reals value = mixed_value(find_nodes(nodes, tables, layout->stride, row, mu), layout->stride, k);
  if (layout->overlapping && row >= layout->derived_row)
    value = value / load_cover(cover, cover_breaks, layout->channels, k, mu);
  store_reals(dense + i * KB_WIDTH, value);
}
