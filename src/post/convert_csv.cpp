// Tables of pixels and regions (convert.hpp).
#include <algorithm>
#include <cmath>

#include "cube/csv_fields.hpp"
#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "files/atomic_file.hpp"
#include "post/convert.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kTileRows = 32;  // of our EXR files, which are read by whole tiles

/// Per band the value and, where it is known, the standard error (empty otherwise), with as many digits as
/// their type has.
struct Place {
  std::vector<std::string> value, error;
  uint64_t infinite = 0;

  template <class Number>
  void add_value(Number number) {
    value.push_back(format_number(number));
    infinite += std::isinf(number);
  }
  template <class Number>
  void add_error(Number number) {
    error.push_back(format_number(number));
    infinite += std::isinf(number);
  }
};

Place read_pixel(CubeReader& source, uint32_t x, uint32_t y) {
  const std::size_t bands = source.info().bands.size();
  std::vector<float> mean(source.info().width * bands), variance(source.info().variance ? mean.size() : 0);
  source.read_rows(y, 1, mean, variance);
  Place place;
  for (std::size_t k = x * bands; k < (x + std::size_t{1}) * bands; ++k) {
    place.add_value(mean[k]);
    if (!variance.empty()) place.add_error(std::sqrt(variance[k]));
  }
  return place;
}

/// Means over the pixels of a region, by band.
std::vector<double> region_means(CubeReader& source, const PixelRect& region) {
  const std::size_t bands = source.info().bands.size(), width = source.info().width;
  std::vector<double> sum(bands, 0);
  std::vector<uint64_t> count(bands, 0);
  std::vector<float> strip;
  const uint32_t end = region.y0 + region.height;
  for (uint32_t y = region.y0, next; y < end; y = next) {
    next = std::min(end, (y / kTileRows + 1) * kTileRows);
    strip.resize((next - y) * width * bands);
    source.read_rows(y, next - y, strip, {});
    for (std::size_t row = 0; row < next - y; ++row)
      for (std::size_t x = region.x0; x < region.x0 + std::size_t{region.width}; ++x)
        for (std::size_t k = 0; k < bands; ++k)
          if (const float v = strip[(row * width + x) * bands + k]; !std::isnan(v)) sum[k] += v, ++count[k];
  }
  for (std::size_t k = 0; k < bands; ++k)
    sum[k] = count[k] > 0 ? sum[k] / static_cast<double>(count[k]) : std::nan("");
  return sum;
}

Place read_region(CubeReader& source, const PixelRect& region) {
  Place place;
  for (const double mean : region_means(source, region)) place.add_value(mean);
  return place;
}

/// A place with the errors that the replicates give.
Place read_replicated(ReplicatedCube& source, const PixelRect& region) {
  Place place = read_region(*source.mean, region);
  std::vector<std::vector<double>> means;
  for (const auto& replicate : source.replicates) means.push_back(region_means(*replicate, region));
  std::vector<double> values(means.size());
  for (std::size_t k = 0; k < place.value.size(); ++k) {
    for (std::size_t r = 0; r < means.size(); ++r) values[r] = means[r][k];
    place.add_error(replicate_error(values, source.samples));
  }
  return place;
}

void check_places(const CubeInfo& info, const std::vector<PixelRect>& places) {
  if (places.empty()) throw InputError("CSV: no pixel or region is given");
  for (const PixelRect& place : places) check_region(info, place);
}

template <class ReadPlace>
void write_places(const CubeInfo& info, const std::filesystem::path& out,
                  const std::vector<PixelRect>& places, bool errors, const DiagnosticSink& sink,
                  const ReadPlace& read_place) {
  uint64_t infinite = 0;
  const bool several = places.size() > 1;
  std::string text = several ? "x,y,width,height," : "";
  text += "channel,min_nm,max_nm,value" + std::string(errors ? ",standard_error" : "") + "\n";
  const std::vector<std::string> names = unique_band_names(info.bands);
  for (const PixelRect& p : places) {
    const Place place = read_place(p);
    infinite += place.infinite;
    std::string prefix;
    if (several)
      for (const uint32_t number : {p.x0, p.y0, p.width, p.height}) prefix += std::to_string(number) + ",";
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Channel& c = info.bands[k].channel;
      text += prefix + csv_text(names[k]) + "," + csv_bound(c, c.min_nm) + "," + csv_bound(c, c.max_nm) +
              "," + place.value[k];
      if (errors) text += "," + (place.error.empty() ? std::string() : place.error[k]);
      text += "\n";
    }
  }
  write_file_atomically(out, text);
  if (infinite > 0)
    warn(sink, {out.string(), 0, 0}, std::to_string(infinite) + " values or standard errors are infinite");
}

}  // namespace

void write_csv(CubeReader& source, const std::filesystem::path& out, const std::vector<PixelRect>& places,
               const DiagnosticSink& sink) {
  const CubeInfo& info = source.info();
  check_places(info, places);
  const auto is_pixel = [](const PixelRect& p) { return p.pixels() == 1; };
  const bool errors = info.variance && std::any_of(places.begin(), places.end(), is_pixel);
  write_places(info, out, places, errors, sink, [&](const PixelRect& p) {
    return is_pixel(p) ? read_pixel(source, p.x0, p.y0) : read_region(source, p);
  });
}

void write_csv(ReplicatedCube& source, const std::filesystem::path& out, const std::vector<PixelRect>& places,
               const DiagnosticSink& sink) {
  if (!source.has_errors()) return write_csv(*source.mean, out, places, sink);
  check_places(source.mean->info(), places);
  write_places(source.mean->info(), out, places, true, sink,
               [&](const PixelRect& p) { return read_replicated(source, p); });
}

}  // namespace kiloband
