// Scenes for tests of device evaluation, and what the double-precision oracle says of them.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "device_evaluator.hpp"
#include "tests/unit/src_cpu/evaluate/random_scene.hpp"

namespace kiloband::test {

using namespace cpu;

/// "width4x2_per_path": what tests with a build as their parameter are called by.
std::string build_name(const testing::TestParamInfo<EvaluatorBuild>& info);

/// make_scene() with tables whose kinks meet nodes: steps that are simple fractions of a channel for equal
/// channels, straight lines for others, so that interpolation is exact and what is compared is evaluation.
FlatScene make_device_scene(std::size_t count, Layout layout, std::mt19937& random);

/// Every path once, and some samples that are empty or invalid. Pixels are in two blocks.
RoundOfPaths make_round(const PathBuffer& paths, uint32_t pixels, uint32_t samples, std::mt19937& random);

/// What a round comes to, in film units.
struct Expected {
  std::vector<double> means;  // [pixel][K + D]
  std::vector<double>
      magnitude;  // the same with the largest values over mu in place of those at the path's mu
  std::vector<uint32_t> counts;
};

Expected reference(const FlatScene& scene, const DerivedChannels& derived,
                   const opencl::ChannelTables& tables, const PathBuffer& paths, const RoundOfPaths& round,
                   bool per_path);

/// Largest |value - mean| / magnitude.
double largest_error(const std::vector<float>& values, const Expected& expected);
/// Largest |a - b| / magnitude.
double largest_difference(const std::vector<float>& a, const std::vector<float>& b, const Expected& expected);

}  // namespace kiloband::test
