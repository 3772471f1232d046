#include "src_cpu/lanes/one_lane.hpp"
// After the lanes that it is to be compiled for.
#include "bsdf_functions-inl.hpp"

namespace kiloband::test {

LaneAnswers answers_of_one_lane(const LaneQueries& queries) {
  return cpu::one_lane::answer_queries(queries);
}

}  // namespace kiloband::test
