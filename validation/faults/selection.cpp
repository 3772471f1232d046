#include "validation/faults/selection.hpp"

#include <cstdlib>
#include <stdexcept>

#include "shared/planted_faults.h"
#include "validation/faults/table.hpp"

namespace kiloband::faults {
namespace {

struct Selection {
  uint32_t cpu = KB_PLANTED_NONE, opencl = KB_PLANTED_NONE, shared = KB_PLANTED_NONE;
};

/// throws std::invalid_argument
Selection parse(const std::string& text) {
  Selection selection;
  if (text == "none" || text.empty()) return selection;
  const auto colon = text.find(':');
  const std::string place = text.substr(0, colon);
  const PlantedFault* fault = colon == std::string::npos ? nullptr : find_fault(text.substr(colon + 1));
  if (!fault)
    throw std::invalid_argument("fault '" + text +
                                "': must be none, or cpu:, opencl: or shared: and a name of "
                                "validation/faults/table.cpp");
  if (place == "cpu" && (fault->where & kCpu)) {
    selection.cpu = fault->number;
  } else if (place == "opencl" && (fault->where & kOpencl)) {
    selection.opencl = fault->number;
  } else if (place == "shared" && (fault->where & kShared)) {
    selection.shared = fault->number;
  } else {
    throw std::invalid_argument("fault '" + text + "': there is none of that name in '" + place + "'");
  }
  return selection;
}

/// Read once, before main().
const Selection& of_environment() {
  static const Selection selection = [] {
    const char* text = std::getenv("KILOBAND_FAULT");
    return parse(text ? text : "");
  }();
  return selection;
}

}  // namespace
}  // namespace kiloband::faults

uint32_t kb_planted_cpu = kiloband::faults::of_environment().cpu;
uint32_t kb_planted_opencl = kiloband::faults::of_environment().opencl;
uint32_t kb_planted_shared = kiloband::faults::of_environment().shared;

namespace kiloband::faults {

void select_fault(const std::string& text) {
  const Selection selection = parse(text);
  kb_planted_cpu = selection.cpu;
  kb_planted_opencl = selection.opencl;
  kb_planted_shared = selection.shared;
}

std::string selected_fault() {
  const auto named = [](const char* place, uint32_t number) {
    return place + std::string(find_fault(number)->name);
  };
  if (kb_planted_cpu != KB_PLANTED_NONE) return named("cpu:", kb_planted_cpu);
  if (kb_planted_opencl != KB_PLANTED_NONE) return named("opencl:", kb_planted_opencl);
  if (kb_planted_shared != KB_PLANTED_NONE) return named("shared:", kb_planted_shared);
  return "none";
}

}  // namespace kiloband::faults
