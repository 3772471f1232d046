#include "viewer/api/selections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/deal_ranges.hpp"
#include "base/number.hpp"
#include "base/text.hpp"

namespace kiloband::viewer {
namespace {

constexpr float kNoCurve = std::numeric_limits<float>::quiet_NaN();

/// The parts of a text between separators.
std::vector<std::string_view> parts_of(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

Selection parse_selection(std::string_view text, uint32_t width, uint32_t height) {
  std::vector<uint32_t> n;
  for (const std::string_view part : parts_of(text, ','))
    n.push_back(whole_number<uint32_t>(part).value_or(~0u));
  if (n.size() == 2) n.insert(n.end(), {n[0], n[1]});
  if (n.size() != 4 || std::ranges::find(n, ~0u) != n.end())
    throw InputError("select: " + quote_text(text) +
                     ": must be X,Y or X0,Y0,X1,Y1 with whole numbers from 0");
  if (n[2] < n[0] || n[3] < n[1]) throw InputError("select: " + quote_text(text) + ": ends before it begins");
  if (n[2] >= width || n[3] >= height)
    throw InputError(
        fmt::format("select: {}: the image has {} x {} pixels", quote_text(text), width, height));
  return {std::string(text), n[0], n[1], n[2], n[3]};
}

struct CurveSums {
  CurveSums() = default;
  explicit CurveSums(std::size_t bands) : mean(bands), variance(bands), values(bands) {}

  std::vector<double> mean, variance;
  std::vector<uint64_t> values;  // per band, without NaN
  uint64_t pixels = 0;           // with any
};

Curve curve_of(const CurveSums& sums, const PixelSource& source) {
  Curve curve{sums.pixels, {}, {}};
  for (std::size_t k = 0; k < sums.mean.size(); ++k) {
    const Band& band = source.bands()[k];
    const double n = static_cast<double>(sums.values[k]);
    const bool is_known = sums.values[k] == 1 || source.has_independent_errors();
    const double scale = source.units()[k] / (band.derived ? 1 : band.channel.width_nm());
    curve.mean.push_back(static_cast<float>(sums.mean[k] / n * scale));  // NaN without values
    curve.standard_error.push_back(is_known ? static_cast<float>(std::sqrt(sums.variance[k]) / n * scale)
                                            : kNoCurve);
  }
  return curve;
}

/// Pixels x0 .. x1 of a row. All bands at once, without branches: rectangles may have as many values as the image.
void add_row(const float* means, const float* variances, uint32_t x0, uint32_t x1, CurveSums& sums) {
  const std::size_t bands = sums.mean.size();
  for (std::size_t x = x0; x <= x1; ++x) {
    uint64_t known = 0;
    for (std::size_t k = 0; k < bands; ++k) {
      const float mean = means[x * bands + k], variance = variances[x * bands + k];
      const bool is_known = !std::isnan(mean);
      known |= uint64_t{is_known};
      sums.values[k] += uint64_t{is_known};
      sums.mean[k] += is_known ? double{mean} : 0.0;
      sums.variance[k] += is_known ? double{variance} : 0.0;
    }
    sums.pixels += known;
  }
}

void add(const CurveSums& part, CurveSums& sums) {
  for (std::size_t k = 0; k < sums.mean.size(); ++k) {
    sums.mean[k] += part.mean[k];
    sums.variance[k] += part.variance[k];
    sums.values[k] += part.values[k];
  }
  sums.pixels += part.pixels;
}

/// The sums of all selections over rows first .. end - 1; those of selections that have none of them stay empty.
std::vector<CurveSums> sums_of_rows(const PixelSource& pixels, const std::vector<Selection>& selections,
                                    uint32_t first, uint32_t end) {
  const std::size_t bands = pixels.bands().size();
  std::vector<CurveSums> sums(selections.size());
  std::vector<float> means, variances;
  for (uint32_t y = first; y < end; ++y) {
    bool is_read = false;
    for (std::size_t i = 0; i < selections.size(); ++i) {
      const Selection& s = selections[i];
      if (y < s.y0 || y > s.y1) continue;
      if (!std::exchange(is_read, true)) {
        means.resize(pixels.width() * bands);
        variances.resize(means.size());
        pixels.means(y, means);
        pixels.variances(y, variances);
      }
      if (sums[i].mean.empty()) sums[i] = CurveSums(bands);
      add_row(means.data(), variances.data(), s.x0, s.x1, sums[i]);
    }
  }
  return sums;
}

}  // namespace

uint32_t reduced(uint32_t at, uint32_t full, uint32_t size) {
  return static_cast<uint32_t>(uint64_t{at} * size / full);
}

std::vector<Selection> parse_selections(std::string_view text, uint32_t width, uint32_t height) {
  const std::vector<std::string_view> parts = parts_of(text, ';');
  if (parts.size() > kMostSelections)
    throw InputError(fmt::format("select: {} places: at most {}", parts.size(), kMostSelections));
  std::vector<Selection> selections;
  for (const std::string_view part : parts) selections.push_back(parse_selection(part, width, height));
  return selections;
}

/// Parts of kRows rows are added up in their order, whoever has read them: the same bits for any number of threads.
std::vector<Curve> read_curves(const PixelSource& pixels, std::vector<Selection> selections,
                               uint32_t full_width, uint32_t full_height, unsigned threads) {
  constexpr uint32_t kRows = 16;
  for (Selection& s : selections) {
    s.x0 = reduced(s.x0, full_width, pixels.width()), s.x1 = reduced(s.x1, full_width, pixels.width());
    s.y0 = reduced(s.y0, full_height, pixels.height()), s.y1 = reduced(s.y1, full_height, pixels.height());
  }
  uint32_t top = pixels.height(), bottom = 0;
  for (const Selection& s : selections)
    top = std::min(top, s.y0 / kRows * kRows), bottom = std::max(bottom, s.y1 + 1);
  std::vector<std::vector<CurveSums>> parts(bottom > top ? (bottom - top + kRows - 1) / kRows : 0);
  deal_ranges(parts.size(), threads, [&](std::size_t first, std::size_t end) {
    for (auto part = static_cast<uint32_t>(first); part < end; ++part)
      parts[part] =
          sums_of_rows(pixels, selections, top + part * kRows, std::min(bottom, top + (part + 1) * kRows));
  });
  std::vector<CurveSums> sums(selections.size(), CurveSums(pixels.bands().size()));
  for (const std::vector<CurveSums>& part : parts)
    for (std::size_t i = 0; i < sums.size(); ++i)
      if (!part[i].mean.empty()) add(part[i], sums[i]);
  std::vector<Curve> curves;
  for (const CurveSums& of_selection : sums) curves.push_back(curve_of(of_selection, pixels));
  return curves;
}

}  // namespace kiloband::viewer
