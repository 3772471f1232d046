// Gas for the random scenes and paths of the evaluators' tests.
#pragma once

#include "random_scene.hpp"

namespace kiloband::test {

/// Adds absorption coefficients of line spectra, one of them sorted, and Planck's law for gases
/// to a scene of make_scene().
void add_gas(FlatScene& scene, std::mt19937& random);

/// Paths as those of make_paths() between vertices of gas of every kind: segments that absorb and emit, light
/// that passes one gas or two, gas in front of the emission of another, plumes of 1 to 8 cells. Optical
/// depths from 1e-8 to 30.
PathBuffer make_gas_paths(const FlatScene& scene, std::size_t count, std::mt19937& random);

}  // namespace kiloband::test
