#include "film/convert.hpp"

#include <algorithm>

#include "film/cube_layout.hpp"
#include "film/cube_text.hpp"

namespace kiloband {
namespace {

constexpr uint64_t kStripBytes = uint64_t{128} << 20;

/// Rows whose values fit into the strip's memory: a multiple of 32 (whole tiles of EXR files), or all.
uint32_t strip_rows(const CubeInfo& info) {
  const uint64_t floats = info.bands.size() * (info.variance ? 2 : 1) + info.aux.size();
  const uint64_t rows = kStripBytes / (floats * sizeof(float) * info.width);
  return static_cast<uint32_t>(std::min<uint64_t>(std::max<uint64_t>(rows / 32 * 32, 32), info.height));
}

}  // namespace

void write_cube(CubeReader& source, const std::filesystem::path& out, Quantity quantity_on_disk) {
  CubeInfo info = source.info();
  const Quantity given = info.quantity;
  info.quantity = quantity_on_disk;
  const uint32_t strip = strip_rows(info);
  const auto writer = create_cube_writer_from(out, info, strip, given);
  std::vector<float> mean, variance, aux;
  for (uint32_t y = 0; y < info.height; y += strip) {
    const uint32_t rows = std::min(strip, info.height - y);
    const std::size_t pixels = std::size_t{rows} * info.width;
    mean.resize(pixels * info.bands.size());
    variance.resize(info.variance ? mean.size() : 0);
    aux.resize(pixels * info.aux.size());
    source.read_rows(y, rows, mean, variance);
    source.read_aux(y, rows, aux);
    writer->write_rows({y, rows, mean, variance, aux});
  }
  writer->finish();
}

void convert_cube(const std::filesystem::path& in, const std::filesystem::path& out,
                  const CubeSelection& selection, const DiagnosticSink& sink) {
  const bool exr = to_lower(out.extension().string()) == ".exr";
  const Quantity quantity = selection.quantity.value_or(exr ? Quantity::kDensity : Quantity::kIntegral);
  CubeSelection part = selection;
  part.quantity.reset();  // converted once, by the writer
  // Only sums need the replicates: single channels bring their variances along.
  const auto source =
      part.rebin ? with_replicate_variance(select_from_cube(open_replicated_cube(in, sink), part, sink))
                 : select_from_cube(open_cube(in, sink), part, sink);
  write_cube(*source, out, quantity);
}

}  // namespace kiloband
