// Instruction sets that the CPU backend has code for.
#pragma once

#include <optional>
#include <string_view>

namespace kiloband::cpu {

enum class Isa { kAuto, kSse4, kAvx2, kAvx512 };

/// The name as `--isa` has it: "auto", "sse4", "avx2", "avx512".
const char* to_string(Isa isa);

/// The instruction set of that name; nothing: there is none.
std::optional<Isa> find_isa(std::string_view name);

/// True if the program has code for `isa` and this machine runs it; kAuto always does.
bool is_available(Isa isa);

/// The best instruction set of this machine that the program has code for if `wanted` is
/// kAuto, else `wanted`.
/// throws DeviceError  the machine or the program lacks it
Isa resolve_isa(Isa wanted);

}  // namespace kiloband::cpu
