#include "src_gpu/scene/channel_row_sources.hpp"

#include <algorithm>
#include <cmath>

#include "scene/compile/spectra/band_set.hpp"
#include "shared/spectra_layout.h"
#include "spectral/planck.hpp"

namespace kiloband::opencl {
namespace {

RowFunction planck_row(const SpectrumRow& row) {
  RowFunction f;
  const bool tabulated = !row.table.values.empty();
  if (tabulated) f = RowFunction::of_table(row.table);
  f.curved = true;
  f.value = [&row, tabulated](double lambda_nm) {
    if (lambda_nm < row.planck_min_nm || lambda_nm > row.planck_max_nm) return 0.0;
    const double factor = tabulated ? row.planck_scale * row.table(lambda_nm) : row.planck_scale;
    return factor * planck_radiance(lambda_nm, row.temperature_k);
  };
  f.jumps_nm.insert(f.jumps_nm.end(), {row.planck_min_nm, row.planck_max_nm});
  return f;
}

}  // namespace

RowFunction spectrum_row(const SpectrumRow& row) {
  return row.is_planck ? planck_row(row) : RowFunction::of_table(row.table);
}

RowFunction wavelength_row() {
  RowFunction f;
  f.value = [](double lambda_nm) { return std::clamp(lambda_nm, 360.0, 830.0) - KB_TEXTURE_CENTRE_NM; };
  f.kinks_nm = {360, 830};
  return f;
}

RowFunction band_position_row(const BandSet& set) {
  RowFunction f;
  f.value = [&set](double lambda_nm) {
    const BandPosition position = band_position(set, lambda_nm);
    return position.index + position.fraction;
  };
  const std::vector<double>& c = set.centres_nm;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const bool inner = i > 0 && i + 1 < c.size();
    if (!inner || std::abs((c[i + 1] - c[i]) / (c[i] - c[i - 1]) - 1) > 1e-9) f.kinks_nm.push_back(c[i]);
  }
  return f;
}

}  // namespace kiloband::opencl
