#include "validation/suite/hard_cases/hard_cases.hpp"

#include "validation/suite/hard_cases/groups.hpp"

namespace kiloband::validation {

const std::vector<HardCase>& hard_cases() {
  static const std::vector<HardCase> kCases = [] {
    std::vector<HardCase> all;
    for (const auto& group : {geometry_cases, leak_cases, boundary_cases, metal_cases, radiance_cases,
                              wavelength_cases, gas_cases, length_cases}) {
      for (HardCase& one : group()) all.push_back(std::move(one));
    }
    return all;
  }();
  return kCases;
}

}  // namespace kiloband::validation
