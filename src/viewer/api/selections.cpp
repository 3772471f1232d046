#include "viewer/api/selections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

void add_row(const std::vector<float>& means, const std::vector<float>& variances, uint32_t x0, uint32_t x1,
             CurveSums& sums) {
  const std::size_t bands = sums.mean.size();
  for (std::size_t x = x0; x <= x1; ++x) {
    bool has_values = false;
    for (std::size_t k = 0; k < bands; ++k) {
      if (std::isnan(means[x * bands + k])) continue;
      has_values = true;
      ++sums.values[k];
      sums.mean[k] += means[x * bands + k];
      sums.variance[k] += variances[x * bands + k];
    }
    sums.pixels += has_values;
  }
}

/// Where a coordinate of the full image lies in one that may be reduced.
uint32_t reduced(uint32_t at, uint32_t full, uint32_t size) {
  return static_cast<uint32_t>(uint64_t{at} * size / full);
}

}  // namespace

std::vector<Selection> parse_selections(std::string_view text, uint32_t width, uint32_t height) {
  const std::vector<std::string_view> parts = parts_of(text, ';');
  if (parts.size() > kMostSelections)
    throw InputError(fmt::format("select: {} places: at most {}", parts.size(), kMostSelections));
  std::vector<Selection> selections;
  for (const std::string_view part : parts) selections.push_back(parse_selection(part, width, height));
  return selections;
}

std::vector<Curve> read_curves(const PixelSource& pixels, const std::vector<Selection>& selections,
                               uint32_t full_width, uint32_t full_height) {
  const std::size_t bands = pixels.bands().size();
  std::vector<CurveSums> sums(selections.size(), {std::vector<double>(bands), std::vector<double>(bands),
                                                  std::vector<uint64_t>(bands), 0});
  std::vector<float> means(pixels.width() * bands), variances(pixels.width() * bands);
  for (uint32_t y = 0; y < pixels.height(); ++y) {
    bool is_read = false;
    for (std::size_t i = 0; i < selections.size(); ++i) {
      const Selection& s = selections[i];
      if (y < reduced(s.y0, full_height, pixels.height()) || y > reduced(s.y1, full_height, pixels.height()))
        continue;
      if (!is_read) {
        pixels.means(y, means);
        pixels.variances(y, variances);
        is_read = true;
      }
      add_row(means, variances, reduced(s.x0, full_width, pixels.width()),
              reduced(s.x1, full_width, pixels.width()), sums[i]);
    }
  }
  std::vector<Curve> curves;
  for (const CurveSums& of_selection : sums) curves.push_back(curve_of(of_selection, pixels));
  return curves;
}

}  // namespace kiloband::viewer
