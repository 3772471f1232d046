// Tables of pixels and regions (convert.hpp).
#include <algorithm>
#include <cmath>

#include "film/atomic_file.hpp"
#include "film/convert.hpp"
#include "film/cube_layout.hpp"
#include "film/cube_text.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kTileRows = 32;  // of our EXR files, which are read by whole tiles

/// RFC 4180: quoted where a comma, a quote or a line break would confuse.
std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// Per band the value and, for single pixels of cubes with variances, the standard error (empty otherwise).
struct Place {
  std::vector<std::string> value, error;
};

Place read_pixel(CubeReader& source, uint32_t x, uint32_t y) {
  const std::size_t bands = source.info().bands.size();
  std::vector<float> mean(source.info().width * bands), variance(source.info().variance ? mean.size() : 0);
  source.read_rows(y, 1, mean, variance);
  Place place;
  for (std::size_t k = x * bands; k < (x + std::size_t{1}) * bands; ++k) {
    place.value.push_back(format_number(mean[k]));
    place.error.push_back(variance.empty() ? "" : format_number(std::sqrt(variance[k])));
  }
  return place;
}

Place read_region(CubeReader& source, const PixelRect& region) {
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
  Place place;
  for (std::size_t k = 0; k < bands; ++k)
    place.value.push_back(
        format_number(count[k] > 0 ? sum[k] / static_cast<double>(count[k]) : std::nan("")));
  place.error.resize(bands);
  return place;
}

std::string bound_text(const Channel& c, double nm) {
  return c.min_nm < c.max_nm ? format_number(nm) : "";
}

}  // namespace

void write_csv(CubeReader& source, const std::filesystem::path& out, const std::vector<PixelRect>& places) {
  const CubeInfo& info = source.info();
  if (places.empty()) throw InputError("CSV: no pixel or region is given");
  for (const PixelRect& place : places) check_region(info, place);
  const auto is_pixel = [](const PixelRect& p) { return p.pixels() == 1; };
  const bool errors = info.variance && std::any_of(places.begin(), places.end(), is_pixel);
  const bool several = places.size() > 1;
  std::string text = several ? "x,y,width,height," : "";
  text += "channel,min_nm,max_nm,value" + std::string(errors ? ",standard_error" : "") + "\n";
  const std::vector<std::string> names = unique_band_names(info.bands);
  for (const PixelRect& p : places) {
    const Place place = is_pixel(p) ? read_pixel(source, p.x0, p.y0) : read_region(source, p);
    std::string prefix;
    if (several)
      for (const uint32_t number : {p.x0, p.y0, p.width, p.height}) prefix += std::to_string(number) + ",";
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Channel& c = info.bands[k].channel;
      text += prefix + csv_text(names[k]) + "," + bound_text(c, c.min_nm) + "," + bound_text(c, c.max_nm) +
              "," + place.value[k] + (errors ? "," + place.error[k] : "") + "\n";
    }
  }
  write_file_atomically(out, text);
}

}  // namespace kiloband
