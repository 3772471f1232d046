// Rows of channel tables between their kinks and jumps: means of channels, and knots.
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "src_gpu/scene/channel_row.hpp"

namespace kiloband::opencl {
namespace {

/// Steps of a curved row from break to break.
constexpr int kCurvedSteps = 64;

/// A row between two wavelengths, without a break inside, has its limits from inside there.
double right_of(const RowFunction& row, double lambda_nm) {
  return row.value(lambda_nm * (1 + 10 * kSameWavelength));
}
double left_of(const RowFunction& row, double lambda_nm) {
  return row.value(lambda_nm * (1 - 10 * kSameWavelength));
}

/// All kinks and jumps, ascending, each once.
std::vector<double> breaks_of(const RowFunction& row) {
  std::vector<double> all = row.kinks_nm;
  all.insert(all.end(), row.jumps_nm.begin(), row.jumps_nm.end());
  std::ranges::sort(all);
  const auto same = [](double a, double b) { return b - a <= kSameWavelength * b; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

/// Those strictly between two wavelengths.
std::span<const double> between(const std::vector<double>& breaks, double low_nm, double high_nm) {
  const auto first = std::ranges::upper_bound(breaks, low_nm * (1 + kSameWavelength));
  const auto end = std::ranges::lower_bound(breaks, high_nm * (1 - kSameWavelength));
  return first < end ? std::span<const double>(first, end) : std::span<const double>();
}

/// Integral of the row where nothing breaks it.
double smooth_integral(const RowFunction& row, double low_nm, double high_nm) {
  const double ends = right_of(row, low_nm) + left_of(row, high_nm);
  if (!row.curved) return 0.5 * ends * (high_nm - low_nm);
  double inner = 0;  // Simpson's rule
  for (int i = 1; i < kCurvedSteps; ++i)
    inner += (i % 2 == 1 ? 4 : 2) * row.value(low_nm + (high_nm - low_nm) * i / kCurvedSteps);
  return (ends + inner) * (high_nm - low_nm) / (3.0 * kCurvedSteps);
}

double integral(const RowFunction& row, const std::vector<double>& breaks, double low_nm, double high_nm) {
  double sum = 0, from_nm = low_nm;
  for (const double next_nm : between(breaks, low_nm, high_nm)) {
    sum += smooth_integral(row, from_nm, next_nm);
    from_nm = next_nm;
  }
  return sum + smooth_integral(row, from_nm, high_nm);
}

/// By how much the ramps over the cells with a break miss the row's integral over the channel.
double missed_integral(const RowFunction& row, const std::vector<double>& breaks, const Channel& c,
                       uint32_t cells) {
  const std::span<const double> inside = between(breaks, c.min_nm, c.max_nm);
  const auto edge_nm = [&](double j) { return c.min_nm + c.width_nm() * j / cells; };
  const auto node = [&](double j) { return node_value(row, c, static_cast<uint32_t>(j), cells); };
  double missed = 0, last = -1;
  for (const double at_nm : inside) {
    const double cell = std::min(std::floor((at_nm - c.min_nm) / c.width_nm() * cells), cells - 1.0);
    if (cell < last) continue;
    const double end =
        std::min(cell + 1, cells - 1.0);  // a jump that meets a node is a ramp on one side of it
    for (double j = std::max({cell - 1, last + 1, 0.0}); j <= end; ++j)
      missed += 0.5 * (node(j) + node(j + 1)) * c.width_nm() / cells -
                integral(row, breaks, edge_nm(j), edge_nm(j + 1));
    last = end;
  }
  return missed;
}

/// Appends the row from one break to the next, without the last.
void append_piece(const RowFunction& row, const Channel& c, double low_nm, double high_nm,
                  ChannelKnots& knots) {
  const int steps = row.curved ? kCurvedSteps : 1;
  for (int i = 0; i < steps; ++i) {
    const double lambda_nm = low_nm + (high_nm - low_nm) * i / steps;
    knots.mu.push_back((lambda_nm - c.min_nm) / c.width_nm());
    knots.value.push_back(i == 0 ? right_of(row, lambda_nm) : row.value(lambda_nm));
  }
}

}  // namespace

double mean_error_of_cells(const RowFunction& row, const ChannelList& channels, uint32_t cells) {
  const std::vector<double> breaks = breaks_of(row);
  double largest = 0;
  for (const Channel& c : channels) {
    const double missed = std::abs(missed_integral(row, breaks, c, cells));
    if (missed == 0) continue;
    const double whole = std::abs(integral(row, breaks, c.min_nm, c.max_nm));
    largest = std::max(largest, whole > 0 ? missed / whole : 1);
  }
  return largest;
}

ChannelKnots knots_of(const RowFunction& row, const ChannelList& channels, const RowUnits& units) {
  const std::vector<double> breaks = breaks_of(row);
  ChannelKnots knots;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const Channel& c = channels[k];
    const std::size_t first = knots.mu.size();
    knots.first.push_back(static_cast<uint32_t>(first));
    double from_nm = c.min_nm;
    for (const double next_nm : between(breaks, c.min_nm, c.max_nm)) {
      append_piece(row, c, from_nm, next_nm, knots);
      knots.mu.push_back((next_nm - c.min_nm) / c.width_nm());
      knots.value.push_back(left_of(row, next_nm));
      from_nm = next_nm;
    }
    append_piece(row, c, from_nm, c.max_nm, knots);
    knots.mu.push_back(1);
    knots.value.push_back(left_of(row, c.max_nm));
    for (std::size_t i = first; i < knots.mu.size(); ++i) {
      if (!units.factor.empty()) knots.value[i] *= units.factor[k];
      if (!units.shift.empty()) knots.value[i] -= units.shift[k];
    }
  }
  knots.first.push_back(static_cast<uint32_t>(knots.mu.size()));
  return knots;
}

}  // namespace kiloband::opencl
