#include "app/options/option_values.hpp"

#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "base/error.hpp"

namespace kiloband {
namespace {

/// The number at the beginning and what follows it; (0, text) if there is none.
std::pair<double, std::string> split_unit(const std::string& text) {
  try {
    std::size_t end = 0;
    const double value = std::stod(text, &end);
    return {value, text.substr(end)};
  } catch (const std::exception&) {
    return {0, text};
  }
}

}  // namespace

double parse_duration(const std::string& option, const std::string& text) {
  static const std::map<std::string, double> kUnits{{"", 1}, {"s", 1}, {"min", 60}, {"h", 3600}};
  const auto [value, name] = split_unit(text);
  const auto unit = kUnits.find(name);
  if (unit == kUnits.end() || !(value > 0) || value * unit->second > 1e9) {
    throw InputError(option + " " + text + ": must be a positive time such as 60s, 5min or 2h");
  }
  return value * unit->second;
}

double parse_error(const std::string& option, const std::string& text) {
  const auto [value, unit] = split_unit(text);
  if ((unit != "" && unit != "%") || !(value > 0) || !std::isfinite(value)) {
    throw InputError(option + " " + text + ": must be positive, such as 1% or 0.01");
  }
  if (unit == "" && value >= 1) {
    throw InputError(option + " " + text + ": must have a % from 1 on, such as 1%; without it, be below 1");
  }
  return unit == "%" ? value / 100 : value;
}

}  // namespace kiloband
