#include "stats/comparison/sides.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kiloband::stats {
namespace {

std::size_t second_replicates(Kind kind, uint32_t replicates_b) {
  return kind == Kind::kTruth ? 1 : replicates_b;
}

/// A truth pools with the weight of the samples that it is held against.
UnitSample truth_unit(const std::vector<double>& values, std::size_t first, const UnitSample& a) {
  UnitSample unit{a.channels, std::vector<double>(a.channels), {0}};
  for (const double w : a.weights) unit.weights[0] += w;
  for (std::size_t c = 0; c < a.channels && !values.empty(); ++c) unit.means[c] = values[first + c];
  return unit;
}

bool is_finite(const UnitSample& unit) {
  return std::ranges::all_of(unit.means, [](double v) { return std::isfinite(v); });
}

/// Without samples, and without numbers that could spoil a sum.
void drop(UnitSample& unit) {
  std::ranges::fill(unit.means, 0);
  std::ranges::fill(unit.weights, 0);
}

}  // namespace

SidesPool::SidesPool(Kind kind, std::size_t channels, uint32_t replicates_a, uint32_t replicates_b)
    : a_(replicates_a, channels),
      b_(second_replicates(kind, replicates_b), channels),
      bound_(kind == Kind::kTruth ? 1 : 0, channels) {}

void SidesPool::add(const Sides& unit) {
  a_.add(unit.a);
  b_.add(unit.b);
  bound_.add(unit.bound);
}

void SidesPool::add_marked(const Sides& unit, const std::vector<bool>& channels) {
  a_.add_marked(unit.a, channels);
  b_.add_marked(unit.b, channels);
  bound_.add_marked(unit.bound, channels);
}

Sides SidesPool::mean() const {
  return {a_.mean(), b_.mean(), bound_.mean()};
}

void SidesPool::clear() {
  a_.clear();
  b_.clear();
  bound_.clear();
}

std::size_t PixelSource::gather(std::size_t pixel, Sides& out) const {
  std::size_t lost = gather_pixel(a_, pixel, out.a);
  if (b_ != nullptr) return lost + gather_pixel(*b_, pixel, out.b);
  const std::size_t first = truth_->per_pixel ? pixel * a_.channels : 0;
  out.b = truth_unit(truth_->value, first, out.a);
  out.bound = truth_unit(truth_->bound, first, out.a);
  if (is_finite(out.b) && is_finite(out.bound)) return lost;
  lost += out.a.sampled() > 0;
  for (UnitSample* side : {&out.a, &out.b, &out.bound}) drop(*side);
  return lost;
}

Contrast contrast_of(Kind kind, const Sides& sides, double rounding) {
  switch (kind) {
    case Kind::kIndependent:
      return independent_contrast(sides.a, sides.b, rounding);
    case Kind::kPaired:
      return paired_contrast(sides.a, sides.b, rounding);
    case Kind::kTruth:
      return truth_contrast(sides.a, {sides.b.means, sides.bound.means}, rounding);
  }
  throw std::logic_error("contrast_of: unknown kind");
}

void AgreeingArea::add(const Contrast& pixel) {
  ++pixels_;
  for (std::size_t c = 0; c < pixel.agreement.size(); ++c)
    different_[c] += pixel.agreement[c] > 0 && pixel.t(c) != 0;
}

void AgreeingArea::add(const AgreeingArea& part) {
  pixels_ += part.pixels_;
  for (std::size_t c = 0; c < different_.size(); ++c) different_[c] += part.different_[c];
}

void AgreeingArea::settle(Contrast& contrast) const {
  for (std::size_t c = 0; c < contrast.agreement.size(); ++c) {
    if (2 * different_[c] > pixels_) contrast.agreement[c] = 0;
  }
}

void AgreeingArea::clear() {
  pixels_ = 0;
  std::ranges::fill(different_, 0);
}

std::vector<bool> testable_channels(Kind kind, const Sides& sides, std::size_t& thin) {
  std::vector<bool> testable(sides.a.channels);
  thin = 0;
  for (std::size_t c = 0; c < testable.size(); ++c) {
    const double found = contributions(sides.a, c) + (kind == Kind::kTruth ? 0 : contributions(sides.b, c));
    const bool empty = found == 0 && (kind != Kind::kTruth || sides.b.means[c] == 0);
    testable[c] = empty || found >= kMinContributions;
    thin += !testable[c];
  }
  return testable;
}

}  // namespace kiloband::stats
