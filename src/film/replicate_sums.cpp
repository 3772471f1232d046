#include "film/replicate_sums.hpp"

#include <algorithm>
#include <stdexcept>

namespace kiloband {
namespace {

bool needs_closed(const SumRule& rule, uint32_t most_samples) {
  return most_samples > rule.chunk;
}

void mean_of_folded(bool closed, const PixelSumsView& sums, std::span<float> mean) {
  if (!closed) {
    const auto factor = static_cast<float>(1.0 / sums.count);
    for (std::size_t c = 0; c < mean.size(); ++c) mean[c] = sums.open[c] * factor;
    return;
  }
  const double factor = 1.0 / sums.count;
  for (std::size_t c = 0; c < mean.size(); ++c)
    mean[c] = static_cast<float>((std::bit_cast<double>(sums.closed[c]) + sums.open[c]) * factor);
}

/// As film_finish of kernels/film/film.cl, once the open sum is closed.
void mean_of_compensated(const PixelSumsView& sums, std::span<float> mean) {
  const auto count = static_cast<float>(sums.count);
  for (std::size_t c = 0; c < mean.size(); ++c) {
    const auto closed =
        sums.closed.empty() ? CompensatedSum{} : std::bit_cast<CompensatedSum>(sums.closed[c]);
    const float after = closed.sum + sums.open[c], part = after - closed.sum;
    const float lost = closed.lost + ((closed.sum - (after - part)) + (sums.open[c] - part));
    mean[c] = (after + lost) / count;
  }
}

std::size_t values_of(const ReplicateSums::Shape& shape) {
  return shape.slots * shape.pixels * shape.channels;
}

/// What open sums and counts leave of the memory.
std::size_t memory_for_closed(const ReplicateSums::Shape& shape, std::size_t memory_bytes) {
  return memory_bytes - std::min(memory_bytes, values_of(shape) * sizeof(float));
}

std::size_t memory_beside_counts(const ReplicateSums::Shape& shape, std::size_t memory_bytes) {
  return memory_bytes - std::min(memory_bytes, shape.slots * shape.pixels * sizeof(uint32_t));
}

}  // namespace

void mean_of_sums(const SumRule& rule, uint32_t attempted, const PixelSumsView& sums, std::span<float> mean) {
  if (sums.count == 0) {
    std::ranges::fill(mean, 0.0f);
  } else if (rule.kind == SumRule::Kind::kFolded) {
    mean_of_folded(attempted > rule.chunk, sums, mean);
  } else {
    mean_of_compensated(sums, mean);
  }
}

ReplicateSums::ReplicateSums(const Shape& shape, const SumRule& rule, uint32_t most_samples,
                             std::size_t memory_bytes)
    : shape_(shape),
      rule_(rule),
      open_(values_of(shape), memory_beside_counts(shape, memory_bytes)),
      closed_(needs_closed(rule, most_samples) ? 2 * values_of(shape) : 0,
              memory_for_closed(shape, memory_beside_counts(shape, memory_bytes))),
      counts_(shape.slots * shape.pixels) {}

PixelSums ReplicateSums::at(std::size_t slot, std::size_t pixel) {
  if (slot >= shape_.slots || pixel >= shape_.pixels)
    throw std::logic_error("ReplicateSums::at: no such replicate or pixel");
  const std::size_t unit = slot * shape_.pixels + pixel, first = unit * shape_.channels;
  // Two floats of scratch memory, which is mapped and thus aligned,
  // hold what is only ever used as a ClosedSum.
  auto* const closed = reinterpret_cast<ClosedSum*>(closed_.values().data());
  const bool has_closed = !closed_.values().empty();
  return {counts_[unit], open_.values().subspan(first, shape_.channels),
          has_closed ? std::span(closed + first, shape_.channels) : std::span<ClosedSum>()};
}

PixelSumsView ReplicateSums::at(std::size_t slot, std::size_t pixel) const {
  const PixelSums sums = const_cast<ReplicateSums*>(this)->at(slot, pixel);  // nothing is written through it
  return {sums.count, sums.open, sums.closed};
}

OpenSums ReplicateSums::open(std::size_t slot, std::size_t pixel, std::size_t pixels) {
  if (slot >= shape_.slots || pixel + pixels > shape_.pixels)
    throw std::logic_error("ReplicateSums::open: no such replicate or pixels");
  const std::size_t unit = slot * shape_.pixels + pixel;
  return {std::span(counts_).subspan(unit, pixels),
          open_.values().subspan(unit * shape_.channels, pixels * shape_.channels)};
}

OpenSumsView ReplicateSums::open(std::size_t slot, std::size_t pixel, std::size_t pixels) const {
  const OpenSums sums =
      const_cast<ReplicateSums*>(this)->open(slot, pixel, pixels);  // nothing is written, either
  return {sums.counts, sums.values};
}

std::size_t ReplicateSums::bytes_per_value(const SumRule& rule, uint32_t most_samples) {
  return sizeof(float) + (needs_closed(rule, most_samples) ? sizeof(ClosedSum) : 0);
}

}  // namespace kiloband
