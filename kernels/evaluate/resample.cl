// Dense spectra of shared wavelengths (build macros KB_WIDTH and KB_SPECTRAL_LINES, see path_spectra.clh, and KB_HAS_GAS: Evaluation gives no
// others).
//
//   kernel         work-items
//   resample_rows  blocks * samples of the round * rows * stride / KB_WIDTH
//
// dense[table][row][stride]: every row of KbSpectraLayout at mu = shared_mu[table]; tables are numbered
// block * samples + sample of the round, as shared_mu. Derived channels' rows are divided by the cover.
#include "evaluate/path_spectra.clh"

__kernel void resample_rows(KB_EVALUATION_PARAMS) {
  __constant KbSpectraLayout* layout = spectra_layout;
  const kb_u32 vectors = layout->stride / KB_WIDTH;
  const size_t i = get_global_id(0);
  if (i >= (size_t)pool_round->blocks * pool_round->samples * layout->rows * vectors) return;
  const kb_u32 k = (kb_u32)(i % vectors) * KB_WIDTH;
  const kb_u32 row = (kb_u32)(i / vectors % layout->rows);
  const float mu = pool_shared_mu[i / vectors / layout->rows];
  Reals value;
#if KB_HAS_GAS || KB_SPECTRAL_LINES
  const KbChannelTable table = spectra_tables[row];
  if (table.cells == 0u)
    value = line_values(spectra_nodes, table.first, layout->channels, k, mu);
  else
#endif
    value = mixed_value(find_nodes(spectra_nodes, spectra_tables, layout->stride, row, mu), layout->stride, k);
  if (layout->overlapping && row >= layout->derived_row)
    value = value / load_cover(spectra_cover, spectra_cover_breaks, layout->channels, k, mu);
  store_reals(evaluation_dense + i * KB_WIDTH, value);
}
