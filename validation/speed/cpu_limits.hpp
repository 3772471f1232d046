// What one thread of the CPU can do at most.
#pragma once

#include "src_cpu/lanes/isa.hpp"

namespace kiloband::speed {

/// Floating-point operations per second of multiply-adds in registers: eight independent chains of the set's widest vectors, the
/// best of several attempts of some milliseconds. isa: resolved, not kAuto
double peak_flops_of_thread(cpu::Isa isa);

}  // namespace kiloband::speed
