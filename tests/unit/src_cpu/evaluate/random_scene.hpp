// Synthetic scenes and paths for the evaluator's tests.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "following_rows.hpp"
#include "src_cpu/evaluate/evaluator.hpp"

namespace kiloband::test {

using namespace cpu;

inline double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

enum class Layout { kRegular, kOverlapping, kNarrow, kInfrared };

/// K channels: equal ones over 380-780 nm; of random width and order that overlap and leave gaps; 0.1 nm
/// wide; equal ones over 3-12 um.
ChannelList make_channels(std::size_t count, Layout layout, std::mt19937& random);

/// A scene in which every kind of vertex can occur: reflectances, tabulated and thermal emission, conductors
/// (a perfect mirror too), dispersive dielectrics, a nonlinear plastic, textures of every addressing,
/// spectral ones too. channel_scale follows the brightest emission, as flattening does.
FlatScene make_scene(const ChannelList& channels, std::mt19937& random);

/// Six textures more, after those of colours: bands, bands, mixtures; the first three are reflectances, the
/// others emit. Mixtures are of the spectra from row 0 and row `first_emission` on.
void add_spectral_textures(FlatScene& scene, const Channel& range, uint32_t first_emission,
                           std::mt19937& random);

/// Positive weights: values are sums of positive terms, so that their relative error means something.
PathBuffer make_paths(const FlatScene& scene, std::size_t count, std::mt19937& random);

/// A response that is smooth, one that is narrow, one that is continued, one that no channel meets.
DerivedChannels make_responses();

/// A table from values at a regular step.
RegularTable table(double min_nm, double step_nm, std::vector<double> values, bool extrapolate = false);
SpectrumRow row(RegularTable values, bool is_emission = false);

/// Film of `paths`, evaluated with every path at offset mu.
std::vector<float> evaluate(const FlatScene& scene, const DerivedChannels& derived, const PathBuffer& paths,
                            Isa isa, double mu, bool shared = true);

/// The instruction sets of this machine.
std::vector<Isa> available_isas();

/// Tests that run once per instruction set.
class EachIsa : public testing::TestWithParam<Isa> {};

inline std::string isa_name(const testing::TestParamInfo<Isa>& info) {
  return to_string(info.param);
}

}  // namespace kiloband::test
