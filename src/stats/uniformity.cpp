#include "stats/uniformity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/distributions.hpp"
#include "stats/divisions.hpp"
#include "stats/random.hpp"
#include "stats/scale_test.hpp"

namespace kiloband::stats {
namespace {

constexpr std::size_t kNoChannel = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kBatch = 32;  // divisions at a time

bool varies(const UnitSample& a, const UnitSample* b, std::size_t c) {
  const double first = a.mean_at(0, c);
  for (std::size_t r = 0; r < a.replicates(); ++r) {
    if (a.mean_at(r, c) != first) return true;
  }
  for (std::size_t r = 0; b != nullptr && r < b->replicates(); ++r) {
    if (b->mean_at(r, c) != first) return true;
  }
  return false;
}

/// Contributions to both sides as if they were one: what decides whether a unit is looked at must not know
/// the sides apart, or it would choose those in which they differ.
double joint_contributions(const UnitSample& a, const UnitSample& b, std::size_t c) {
  double zero = 0;
  for (const UnitSample* side : {&a, &b}) {
    for (std::size_t r = 0; r < side->replicates(); ++r) zero += side->mean_at(r, c) == 0;
  }
  const auto all = static_cast<double>(a.replicates() + b.replicates());
  return zero == 0 ? std::numeric_limits<double>::infinity() : -all * std::log(zero / all);
}

/// sup (F_0 - F) over the cells' ends.
double distance(const Cells& cells, std::size_t units, const std::vector<double>& reference) {
  double largest = 0;
  uint64_t below = 0;
  for (std::size_t i = 0; i < kCells; ++i) {
    below += cells[i];
    largest = std::max(largest, reference[i] - static_cast<double>(below) / static_cast<double>(units));
  }
  return largest;
}

std::vector<Cells> draw_cells(const DividedUnits& units, std::size_t count, Random& random) {
  std::vector<Division> divisions;
  for (std::size_t d = 0; d < count; ++d) divisions.push_back(units.draw(random));
  return units.divided(divisions);
}

/// F_0 at the cells' ends.
std::vector<double> reference_of(const DividedUnits& units, Random& random) {
  std::vector<double> reference(kCells);
  for (const Cells& cells : draw_cells(units, kReferenceDivisions, random)) {
    uint64_t below = 0;
    for (std::size_t i = 0; i < kCells; ++i) {
      below += cells[i];
      reference[i] += static_cast<double>(below) / (kReferenceDivisions * static_cast<double>(units.size()));
    }
  }
  return reference;
}

double permutation_p(const DividedUnits& units, double observed, const std::vector<double>& reference,
                     double level, Random& random) {
  const auto most = static_cast<std::size_t>(
      std::min(std::ceil(kUniformityBeyond / level), static_cast<double>(kMostDivisions)));
  double hits = 0;
  for (std::size_t drawn = 0; drawn < most;) {
    for (const Cells& cells : draw_cells(units, std::min(kBatch, most - drawn), random)) {
      ++drawn;
      hits += distance(cells, units.size(), reference) >= observed;
      if (hits >= kUniformityHits) return hits / static_cast<double>(drawn);
    }
  }
  return (1 + hits) / (1 + static_cast<double>(most));
}

}  // namespace

/// Whether the unit that comes may stay.
bool Uniformity::next(uint64_t& order) {
  order = mix_seed(seed_, ++seen_);
  return units_.size() < kUniformityMostUnits || order < units_.front().order;
}

void Uniformity::keep(Unit unit) {
  units_.push_back(std::move(unit));
  std::ranges::push_heap(units_, {}, &Unit::order);
  if (units_.size() <= kUniformityMostUnits) return;
  std::ranges::pop_heap(units_, {}, &Unit::order);
  units_.pop_back();
}

namespace {

std::size_t choose(const std::vector<std::size_t>& channels, uint64_t order) {
  if (channels.empty()) return kNoChannel;
  Random random(order);
  return channels[random.below(channels.size())];
}

}  // namespace

void Uniformity::add(const Contrast& contrast, const UnitSample& a, const UnitSample& b) {
  Unit unit{0, seen_, a.replicates()};
  if (!contrast.valid || a.sampled() < a.replicates() || b.sampled() < b.replicates() || !next(unit.order))
    return;
  std::vector<std::size_t> channels;
  for (std::size_t c = 0; c < contrast.channels; ++c) {
    if (varies(a, &b, c) && joint_contributions(a, b, c) >= kMinContributions) channels.push_back(c);
  }
  const std::size_t c = choose(channels, unit.order);
  if (c == kNoChannel) return;
  for (std::size_t r = 0; r < a.replicates(); ++r) unit.values.push_back(a.mean_at(r, c));
  for (std::size_t r = 0; r < b.replicates(); ++r) unit.values.push_back(b.mean_at(r, c));
  unit.slack = contrast.slack[c];
  unit.p = student_p(contrast.t(c), contrast.dof[c]);
  keep(std::move(unit));
}

void Uniformity::add(const Contrast& contrast, const UnitSample& a, const std::vector<bool>& wanted) {
  Unit unit{0, seen_, a.replicates()};
  if (!contrast.valid || a.sampled() < a.replicates() || !next(unit.order)) return;
  std::vector<std::size_t> channels;
  for (std::size_t c = 0; c < contrast.channels; ++c) {
    if ((wanted.empty() || wanted[c]) && varies(a, nullptr, c)) channels.push_back(c);
  }
  const std::size_t c = choose(channels, unit.order);
  if (c == kNoChannel) return;
  for (std::size_t r = 0; r < a.replicates(); ++r) unit.values.push_back(a.mean_at(r, c) - contrast.b[c]);
  unit.slack = contrast.slack[c];
  unit.p = student_p(contrast.t(c), contrast.dof[c]);
  keep(std::move(unit));
}

UniformityResult Uniformity::finish(double level) {
  UniformityResult result;
  result.units = units_.size();
  if (units_.size() < kUniformityUnits) return result;
  std::ranges::sort(units_, {}, &Unit::index);
  const std::size_t first = units_.front().first;
  DividedUnits units(first, units_.front().values.size() - first);
  for (Unit& unit : units_) {
    units.add(std::move(unit.values), unit.slack);
    result.p_values.push_back(unit.p);
  }
  units_.clear();
  Random random(mix_seed(seed_, 0));
  const std::vector<double> reference = reference_of(units, random);
  result.distance = distance(units.observed(), units.size(), reference);
  result.p = permutation_p(units, result.distance, reference, std::max(level, kUniformityLevel), random);
  return result;
}

}  // namespace kiloband::stats
