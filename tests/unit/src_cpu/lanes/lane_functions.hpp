// The functions of src_cpu/lanes over arrays, compiled for one lane and for every instruction set.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "src_cpu/lanes/isa.hpp"

namespace kiloband::test {

/// in, out: arrays of `count` numbers each; count is a multiple of 16. Words travel as the bits of floats.
using ArrayFunction = void (*)(const float* const* in, float* const* out, std::size_t count);

struct NamedFunction {
  const char* name;
  uint32_t inputs, outputs;
  ArrayFunction apply;
};

/// All of them, in the same order.
const std::vector<NamedFunction>& functions_of_one_lane();
const std::vector<NamedFunction>& functions_of(cpu::Isa isa);

}  // namespace kiloband::test
