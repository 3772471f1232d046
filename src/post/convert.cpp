#include "post/convert.hpp"

#include <algorithm>
#include <cmath>

#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"

namespace kiloband {
namespace {

constexpr uint64_t kStripBytes = uint64_t{128} << 20;

/// Rows whose values, those of all that they are made of too, fit into the strip's memory: a multiple of 32 (whole tiles of EXR files), or
/// all.
uint32_t strip_rows(const CubeReader& source) {
  const CubeInfo& info = source.info();
  const uint64_t rows = kStripBytes / (source.floats_held() * sizeof(float) * info.width);
  return static_cast<uint32_t>(std::min<uint64_t>(std::max<uint64_t>(rows / 32 * 32, 32), info.height));
}

uint64_t count_infinite(const std::vector<float>& values) {
  return static_cast<uint64_t>(std::ranges::count_if(values, [](float v) { return std::isinf(v); }));
}

void warn_of_infinite(const std::filesystem::path& out, const char* what, uint64_t count,
                      const DiagnosticSink& sink) {
  if (count == 0) return;
  warn(sink, {out.string(), 0, 0},
       std::to_string(count) + " " + what + " are infinite: too large for float32");
}

}  // namespace

void write_cube(CubeReader& source, const std::filesystem::path& out, Quantity quantity_on_disk,
                const DiagnosticSink& sink) {
  CubeInfo info = source.info();
  const Quantity given = info.quantity;
  info.quantity = quantity_on_disk;
  const uint32_t strip = strip_rows(source);
  const auto writer = create_cube_writer_from(out, info, strip, given);
  std::vector<float> mean, variance, aux;
  uint64_t values = 0, variances = 0;
  for (uint32_t y = 0; y < info.height; y += strip) {
    const uint32_t rows = std::min(strip, info.height - y);
    const std::size_t pixels = std::size_t{rows} * info.width;
    mean.resize(pixels * info.bands.size());
    variance.resize(info.variance ? mean.size() : 0);
    aux.resize(pixels * info.aux.size());
    source.read_rows(y, rows, mean, variance);
    source.read_aux(y, rows, aux);
    values += count_infinite(mean);
    variances += count_infinite(variance);
    writer->write_rows({y, rows, mean, variance, aux});
  }
  writer->finish();
  warn_of_infinite(out, "values", values + writer->overflowed_values(), sink);
  warn_of_infinite(out, "variances", variances + writer->overflowed_variances(), sink);
}

void convert_cube(const std::filesystem::path& in, const std::filesystem::path& out,
                  const CubeSelection& selection, const DiagnosticSink& sink) {
  const bool exr = lowered_extension(out) == ".exr";
  CubeSelection part = selection;
  part.quantity.reset();  // converted once, by the writer
  // Only sums need the replicates: single channels bring their variances along.
  const auto source =
      part.rebin ? with_replicate_variance(select_from_cube(open_replicated_cube(in, sink), part, sink))
                 : select_from_cube(open_cube(in, sink), part, sink);
  // Densities may be reflectances, and their bands guesses: nothing multiplies them unasked.
  const Quantity kept = exr ? Quantity::kDensity : source->info().quantity;
  write_cube(*source, out, selection.quantity.value_or(kept), sink);
}

}  // namespace kiloband
