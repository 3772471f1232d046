#include "src_cpu/lanes/one_lane.hpp"
// After the lanes that it is to be compiled for.
#include "lane_functions-inl.hpp"

namespace kiloband::test {

const std::vector<NamedFunction>& functions_of_one_lane() {
  static const std::vector<NamedFunction> functions = cpu::one_lane::named_functions();
  return functions;
}

}  // namespace kiloband::test
