// The planted faults: what each does, where, and what should notice it.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace kiloband::faults {

/// Whose copy of the code has the fault; bits of PlantedFault::where.
enum Where : uint32_t {
  kCpu = 1,
  kOpencl = 2,
  kBoth = 3,    // either backend's copy, separately: comparing the backends sees it
  kShared = 4,  // code that both use: only a comparison with theory sees it
};

struct PlantedFault {
  uint32_t number;               // KbPlantedFault
  std::string_view name;         // as selected, "missing-cosine"
  uint32_t where;                // of Where
  std::string_view description;  // what is done wrongly
  std::string_view needs;        // what a scene must have for it to matter
  std::string_view zoo_scene;    // of tests/support/zoo where it shows
  std::string_view caught_by;    // what should notice it
};

/// All of them, by ascending number.
std::span<const PlantedFault> planted_faults();

/// nullptr: there is none of that name or number
const PlantedFault* find_fault(std::string_view name);
const PlantedFault* find_fault(uint32_t number);

}  // namespace kiloband::faults
