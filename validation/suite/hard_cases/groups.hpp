// The cases of each file, for the list in hard_cases.cpp.
#pragma once

#include <vector>

#include "validation/suite/hard_cases/hard_cases.hpp"

namespace kiloband::validation {

std::vector<HardCase> geometry_cases();
std::vector<HardCase> leak_cases();
std::vector<HardCase> boundary_cases();
std::vector<HardCase> metal_cases();
std::vector<HardCase> radiance_cases();
std::vector<HardCase> wavelength_cases();
std::vector<HardCase> gas_cases();
std::vector<HardCase> length_cases();

}  // namespace kiloband::validation
