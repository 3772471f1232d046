// Tables of pixels and regions (convert.hpp).
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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
  uint64_t missing = 0;                   // pixels of a region that some band has no value of
  std::optional<std::size_t> replicates;  // that the errors come from, in the band with the fewest

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

/// Of a pixel. A variance that is below what floats hold was stored as 0: where the error that may hide there is above the mean's
/// rounding it is not known.
float standard_error(float mean, float variance) {
  using Limits = std::numeric_limits<float>;
  const double rounding = double{Limits::epsilon()} * mean;
  if (variance == 0 && mean != 0 && Limits::min() > rounding * rounding) return Limits::quiet_NaN();
  return std::sqrt(variance);
}

Place read_pixel(CubeReader& source, uint32_t x, uint32_t y) {
  const std::size_t bands = source.info().bands.size();
  std::vector<float> mean(source.info().width * bands), variance(source.info().variance ? mean.size() : 0);
  source.read_rows(y, 1, mean, variance);
  Place place;
  for (std::size_t k = x * bands; k < (x + std::size_t{1}) * bands; ++k) {
    place.add_value(mean[k]);
    if (!variance.empty()) place.add_error(standard_error(mean[k], variance[k]));
  }
  return place;
}

/// Means over the pixels of a region that have values, and their number, by band.
struct RegionMeans {
  std::vector<double> mean;
  std::vector<uint64_t> count;
};

RegionMeans region_means(CubeReader& source, const PixelRect& region) {
  const std::size_t bands = source.info().bands.size(), width = source.info().width;
  RegionMeans result{std::vector<double>(bands, 0), std::vector<uint64_t>(bands, 0)};
  auto& [sum, count] = result;
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
  return result;
}

Place place_of(const RegionMeans& region, std::size_t pixels) {
  Place place;
  for (const double mean : region.mean) place.add_value(mean);
  for (const uint64_t count : region.count) place.missing = std::max(place.missing, pixels - count);
  return place;
}

Place read_region(CubeReader& source, const PixelRect& region) {
  return place_of(region_means(source, region), region.pixels());
}

/// A place with the errors that the replicates give. A replicate that lacks pixels of the mean (of an interrupted render) would compare
/// one part of the image with another: it has no value here.
Place read_replicated(ReplicatedCube& source, const PixelRect& region) {
  const RegionMeans whole = region_means(*source.mean, region);
  Place place = place_of(whole, region.pixels());
  std::vector<RegionMeans> parts;
  for (const auto& replicate : source.replicates) parts.push_back(region_means(*replicate, region));
  std::vector<double> values(parts.size());
  std::size_t fewest = parts.size();
  for (std::size_t k = 0; k < place.value.size(); ++k) {
    for (std::size_t r = 0; r < parts.size(); ++r)
      values[r] = parts[r].count[k] == whole.count[k] ? parts[r].mean[k] : std::nan("");
    place.add_error(replicate_error(values, source.samples));
    if (whole.count[k] > 0) fewest = std::min(fewest, count_values(values));
  }
  if (fewest < parts.size()) place.replicates = fewest;
  return place;
}

/// What a number of the table is not of.
void note_gaps(const PixelRect& p, const Place& place, std::size_t replicates, const DiagnosticSink& sink) {
  std::string where = "region";
  for (const uint32_t number : {p.x0, p.y0, p.width, p.height})
    where += (where == "region" ? " " : ",") + std::to_string(number);
  if (p.pixels() == 1) where = "pixel " + std::to_string(p.x0) + "," + std::to_string(p.y0);
  if (place.missing > 0 && p.pixels() > 1)
    note(sink, {},
         where + ": " + std::to_string(place.missing) + " of " + std::to_string(p.pixels()) +
             " pixels have no value and are left out");
  if (!place.replicates) return;
  const std::string some =
      std::to_string(*place.replicates) + " of " + std::to_string(replicates) + " replicates";
  note(sink, {},
       *place.replicates < 2
           ? where + ": no standard errors: " + some + " have all its pixels, two are needed"
           : where + ": standard errors come from " + some + ": the others do not have all its pixels");
}

void check_places(const CubeInfo& info, const std::vector<PixelRect>& places) {
  if (places.empty()) throw InputError("CSV: no pixel or region is given");
  for (const PixelRect& place : places) check_region(info, place);
}

/// replicates: those of the cube
template <class ReadPlace>
void write_places(const CubeInfo& info, const std::filesystem::path& out,
                  const std::vector<PixelRect>& places, bool errors, std::size_t replicates,
                  const DiagnosticSink& sink, const ReadPlace& read_place) {
  uint64_t infinite = 0;
  const bool several = places.size() > 1;
  std::string text = several ? "x,y,width,height," : "";
  text += "channel,min_nm,max_nm,value" + std::string(errors ? ",standard_error" : "") + "\n";
  const std::vector<std::string> names = unique_band_names(info.bands);
  for (const PixelRect& p : places) {
    const Place place = read_place(p);
    infinite += place.infinite;
    note_gaps(p, place, replicates, sink);
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
  write_places(info, out, places, errors, 0, sink, [&](const PixelRect& p) {
    return is_pixel(p) ? read_pixel(source, p.x0, p.y0) : read_region(source, p);
  });
}

void write_csv(ReplicatedCube& source, const std::filesystem::path& out, const std::vector<PixelRect>& places,
               const DiagnosticSink& sink) {
  if (!source.has_errors()) return write_csv(*source.mean, out, places, sink);
  check_places(source.mean->info(), places);
  write_places(source.mean->info(), out, places, true, source.replicates.size(), sink,
               [&](const PixelRect& p) { return read_replicated(source, p); });
}

}  // namespace kiloband
