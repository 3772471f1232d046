#include "scene/read/object/limits.hpp"

#include <cmath>

#include "base/text.hpp"

namespace kiloband {

std::string at_most(double limit, std::string_view unit) {
  return "must be <= " + format_number(limit) + (unit.empty() ? "" : " ") + std::string(unit);
}

void check_at_most(const ObjectReader& object, std::string_view name, double value, double limit,
                   std::string_view unit) {
  object.check(std::abs(value) <= limit, name, value, at_most(limit, unit));
}

}  // namespace kiloband
