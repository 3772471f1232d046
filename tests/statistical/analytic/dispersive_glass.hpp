// A dispersive glass for the tests: index 1.545 to 1.475, linear between four wavelengths.
#pragma once

#include "tests/statistical/analytic/analytic_test.hpp"

namespace kiloband::test {

inline const char* const kDispersionBands = "400-410, 450-460, 500-510, 590-600, 690-700";
inline const Knots kGlassIndex{{{380, 1.545}, {500, 1.515}, {600, 1.49}, {720, 1.475}}};

/// As a file of two columns, nm and n.
inline std::string index_columns() {
  std::string rows;
  for (const auto& [nm, n] : kGlassIndex.points) rows += std::to_string(nm) + " " + std::to_string(n) + "\n";
  return rows;
}

/// A BSDF made of the file glass.txt in air of index 1.
inline std::string glass(const std::string& type, const std::string& more = "") {
  return bsdf(type, text("int_material", "glass.txt") + real("ext_ior", 1.0) + more);
}

}  // namespace kiloband::test
