// The BSDFs over lanes, compiled for one lane and for every instruction set.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/records.h"
#include "src_cpu/lanes/isa.hpp"

namespace kiloband::test {

/// What is asked of every lane, as many of each as there are materials' indices: a multiple of 16.
struct LaneQueries {
  const KbMaterial* materials = nullptr;
  const float* tables = nullptr;
  std::vector<uint32_t> material, active;  // active: 1 or 0
  std::vector<float> channel_eta, u_lobe, probability;
  std::array<std::vector<float>, 3> wi, wo;
  std::array<std::vector<float>, 2> u;
};

/// The numbers of all answers, words and truth values as floats: a row for each.
using LaneAnswers = std::vector<std::vector<float>>;

/// Rows of eval_bsdf (w0, w1, pdf, lobe_b), then of sample_bsdf (wo, w0, w1, pdf, eta, bound, delta, transmission,
/// lobe_b, needs_channel, kind).
inline constexpr std::size_t kValueRows = 4, kSampleRows = 13;

LaneAnswers answers_of_one_lane(const LaneQueries& queries);
LaneAnswers answers_of(cpu::Isa isa, const LaneQueries& queries);

}  // namespace kiloband::test
