#include "src_gpu/scene/channel_row.hpp"

#include <algorithm>
#include <cmath>

namespace kiloband::opencl {
namespace {

/// A node this close to a kink, in cells, meets it.
constexpr double kOnNode = 1e-9;

double lambda_at(const Channel& c, double mu) {
  return (1 - mu) * c.min_nm + mu * c.max_nm;
}

bool is_jump(const RowFunction& row, double lambda_nm) {
  return std::ranges::any_of(
      row.jumps_nm, [&](double j) { return std::abs(lambda_nm - j) <= kSameWavelength * lambda_nm; });
}

}  // namespace

double node_value(const RowFunction& row, const Channel& c, uint32_t j, uint32_t cells) {
  double lambda_nm = lambda_at(c, static_cast<double>(j) / cells);
  if ((j == 0 || j == cells) && is_jump(row, lambda_nm))
    lambda_nm *= 1 + (j == 0 ? 10 : -10) * kSameWavelength;
  return row.value(lambda_nm);
}

namespace {

/// The kinks inside one channel.
struct ChannelKinks {
  uint32_t channel = 0;
  std::size_t first = 0, end = 0;  // of kinks_nm
  double largest = 0;              // |value| in the channel
  std::size_t worst = 0;           // kink that failed last
};

/// Tries numbers of cells on a row. What failed last is tried first, so that unfit numbers cost little.
struct CellSearch {
  CellSearch(const RowFunction& function, const ChannelList& list);

  /// Largest error, or the first found beyond `limit`.
  double error(uint32_t cells, double limit);
  bool jumps_inside() const;
  bool has_kinks() const {
    return std::ranges::any_of(order, [](const ChannelKinks& c) { return c.first < c.end; });
  }

 private:
  double kink_error(const ChannelKinks& c, std::size_t kink, uint32_t cells) const;
  double channel_error(ChannelKinks& c, uint32_t cells, double limit) const;
  double midpoint_error(const ChannelKinks& c, uint32_t cells, double limit) const;
  double error_at(const ChannelKinks& c, double position, uint32_t cells) const;
  bool has_jump_between(double low_nm, double high_nm) const;

  const RowFunction& row;
  const ChannelList& channels;
  std::vector<ChannelKinks> order;
};

CellSearch::CellSearch(const RowFunction& function, const ChannelList& list) : row(function), channels(list) {
  for (uint32_t k = 0; k < channels.size(); ++k) {
    const Channel& c = channels[k];
    ChannelKinks kinks;
    kinks.channel = k;
    const auto first = std::ranges::upper_bound(row.kinks_nm, c.min_nm * (1 + kSameWavelength));
    const auto end = std::ranges::lower_bound(row.kinks_nm, c.max_nm * (1 - kSameWavelength));
    kinks.first = static_cast<std::size_t>(first - row.kinks_nm.begin());
    kinks.end = std::max(kinks.first, static_cast<std::size_t>(end - row.kinks_nm.begin()));
    kinks.worst = kinks.first;
    for (std::size_t i = kinks.first; i < kinks.end; ++i)
      kinks.largest = std::max(kinks.largest, std::abs(row.value(row.kinks_nm[i])));
    const uint32_t samples = row.curved ? 16 : 1;
    for (uint32_t j = 0; j <= samples; ++j)
      kinks.largest = std::max(kinks.largest, std::abs(node_value(row, c, j, samples)));
    order.push_back(kinks);
  }
}

bool CellSearch::has_jump_between(double low_nm, double high_nm) const {
  return std::ranges::any_of(row.jumps_nm, [&](double j) {
    return j > low_nm * (1 - kSameWavelength) && j < high_nm * (1 + kSameWavelength);
  });
}

bool CellSearch::jumps_inside() const {
  return std::ranges::any_of(channels, [&](const Channel& c) {
    return std::ranges::any_of(row.jumps_nm, [&](double j) {
      return j > c.min_nm * (1 + kSameWavelength) && j < c.max_nm * (1 - kSameWavelength);
    });
  });
}

/// |interpolated - row| at a position in cells, relative.
double CellSearch::error_at(const ChannelKinks& c, double position, uint32_t cells) const {
  if (c.largest == 0) return 0;
  const Channel& channel = channels[c.channel];
  const auto j = static_cast<uint32_t>(std::clamp(position, 0.0, cells - 1.0));
  const double t = position - j;
  if (has_jump_between(lambda_at(channel, static_cast<double>(j) / cells),
                       lambda_at(channel, (j + 1.0) / cells)))
    return 0;
  const double between =
      (1 - t) * node_value(row, channel, j, cells) + t * node_value(row, channel, j + 1, cells);
  return std::abs(between - row.value(lambda_at(channel, position / cells))) / c.largest;
}

double CellSearch::kink_error(const ChannelKinks& c, std::size_t kink, uint32_t cells) const {
  const Channel& channel = channels[c.channel];
  const double position = (row.kinks_nm[kink] - channel.min_nm) / channel.width_nm() * cells;
  return std::abs(position - std::round(position)) < kOnNode * cells ? 0 : error_at(c, position, cells);
}

double CellSearch::midpoint_error(const ChannelKinks& c, uint32_t cells, double limit) const {
  double largest = 0;
  for (uint32_t j = 0; j < cells && largest <= limit; ++j)
    largest = std::max(largest, error_at(c, j + 0.5, cells));
  return largest;
}

double CellSearch::channel_error(ChannelKinks& c, uint32_t cells, double limit) const {
  double largest = c.worst < c.end ? kink_error(c, c.worst, cells) : 0;
  for (std::size_t i = c.first; i < c.end && largest <= limit; ++i) {
    const double error = kink_error(c, i, cells);
    if (error <= largest) continue;
    largest = error;
    c.worst = i;
  }
  if (row.curved && largest <= limit) largest = std::max(largest, midpoint_error(c, cells, limit));
  return largest;
}

double CellSearch::error(uint32_t cells, double limit) {
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, channel_error(order[i], cells, limit));
    if (largest <= limit) continue;
    std::swap(order[i], order.front());
    return largest;
  }
  return largest;
}

constexpr double kNoLimit = 1e300;

uint32_t fewest_cells(CellSearch& search, bool kinked, double wanted, double accepted, uint32_t most) {
  for (uint32_t cells = 1; cells <= most; cells = kinked ? cells + 1 : 2 * cells)
    if (search.error(cells, wanted) <= wanted) return cells;
  for (uint32_t cells = 1; cells <= most; cells *= 2)
    if (search.error(cells, accepted) <= accepted) return cells;
  return most;
}

}  // namespace

RowFunction RowFunction::of_table(const RegularTable& table) {
  RowFunction row;
  row.value = [&table](double lambda_nm) { return table(lambda_nm); };
  const std::vector<double>& v = table.values;
  double largest = 0;
  for (const double value : v) largest = std::max(largest, std::abs(value));
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double here_nm = table.min_nm + static_cast<double>(i) * table.step_nm;
    const bool first = i == 0, last = i + 1 == v.size();
    if ((first || last) && !table.extrapolate && v[i] != 0) row.jumps_nm.push_back(here_nm);
    const double before = first ? (table.extrapolate ? v[i] : 0) : v[i - 1];
    const double after = last ? (table.extrapolate ? v[i] : 0) : v[i + 1];
    if (std::abs(before - 2 * v[i] + after) > 1e-12 * largest) row.kinks_nm.push_back(here_nm);
  }
  return row;
}

void RowFunction::merge(const RowFunction& other) {
  std::vector<double> all;
  std::ranges::merge(kinks_nm, other.kinks_nm, std::back_inserter(all));
  kinks_nm = std::move(all);
  jumps_nm.insert(jumps_nm.end(), other.jumps_nm.begin(), other.jumps_nm.end());
}

RowCells choose_cells(const RowFunction& row, const ChannelList& channels, double wanted, double accepted,
                      uint32_t most) {
  CellSearch search(row, channels);
  RowCells result;
  result.has_jump = search.jumps_inside();
  result.cells = fewest_cells(search, search.has_kinks(), wanted, accepted, most);
  if (result.has_jump) result.cells *= most / result.cells;
  result.error = search.error(result.cells, kNoLimit);
  return result;
}

double error_of_cells(const RowFunction& row, const ChannelList& channels, uint32_t cells) {
  return CellSearch(row, channels).error(cells, kNoLimit);
}

void fill_nodes(const RowFunction& row, const ChannelList& channels, const RowUnits& units, uint32_t cells,
                std::size_t stride, float* nodes) {
  for (uint32_t j = 0; j <= cells; ++j) {
    float* out = nodes + j * stride;
    for (std::size_t k = 0; k < channels.size(); ++k) {
      double value = node_value(row, channels[k], j, cells);
      if (!units.factor.empty()) value *= units.factor[k];
      if (!units.shift.empty()) value -= units.shift[k];
      out[k] = static_cast<float>(value);
    }
  }
}

}  // namespace kiloband::opencl
