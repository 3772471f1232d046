// The target that the environment variable KILOBAND_FUZZ_TARGET names, as libFuzzer calls it: one program for all, since linking
// one for each would take longer than a minute's fuzzing of them all.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/fuzz_target.hpp"

namespace kiloband::fuzz {
namespace {

const Target& wanted() {
  const char* const name = std::getenv("KILOBAND_FUZZ_TARGET");
  const auto found = std::ranges::find(targets(), std::string_view(name ? name : ""),
                                       [](const Target& t) { return std::string_view(t.name); });
  if (found != targets().end()) return *found;
  std::fputs("KILOBAND_FUZZ_TARGET must be one of:", stderr);
  for (const Target& target : targets()) std::fprintf(stderr, " %s", target.name);
  std::fputs("\n", stderr);
  std::exit(1);
}

}  // namespace
}  // namespace kiloband::fuzz

static const kiloband::fuzz::Target* target;

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  target = &kiloband::fuzz::wanted();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  target->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
