// Pairs of directions on two sides of rough boundaries, and the factor T of shared/rough_transmission.h by its definition in double.
#pragma once

#include <vector>

#include "random_scene.hpp"

namespace kiloband::test {

struct Direction {
  double x, y, z;
};

/// Pairs on two sides of a boundary of index 1.5 whose facets lean as far as those of the roughness do, each a path to a lamp of
/// radiance 1, and the channels' indices from a near match to a metal oxide's. Channel values are T.
struct RoughPairs {
  RoughPairs(float roughness, bool is_ggx, bool from_inside);

  /// T as it is defined.
  double expected(std::size_t path, std::size_t k) const;

  /// Relative error of T in units of the last place that a rounding of each component of wi + e wo, of third components where they
  /// are made and of the cosines with the facet comes to, besides 12 for T's own operations.
  double allowed(std::size_t path, std::size_t k) const;

  float alpha;
  bool ggx, inside;
  std::vector<double> index;
  FlatScene scene;
  cpu::PathBuffer paths;
};

/// Two directions whose facet is horizontal at index 1.5, 0.2 degrees from it at the indices beside it (channels kHorizontal): T is 0 there.
RoughPairs horizontal_facet();
inline constexpr std::size_t kHorizontal[] = {4, 5, 6};

/// Pairs of Beckmann's distribution whose facet is all but vertical at one of the indices, up to 6.6: T is next to 0 there.
RoughPairs edge_on_facets();

struct Errors {
  double largest = 0;       // in units of what allowed() gives
  std::size_t counted = 0;  // values
};

/// Of values [path][stride], but for values that floats do not hold or that directions leave no digit of.
Errors errors_of(const RoughPairs& pairs, const std::vector<float>& values, std::size_t stride);

}  // namespace kiloband::test
