#include "tests/support/test_backend.hpp"

#include <cstdlib>

#include "render/backend_registry.hpp"
#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/opencl_backend.hpp"

namespace kiloband::test {

std::string test_backend_name() {
  const char* name = std::getenv("KILOBAND_TEST_BACKEND");
  return name && *name ? name : "cpu";
}

std::unique_ptr<Backend> make_test_backend(const FlatScene& scene, const DerivedChannels& derived,
                                           const SamplingSettings& settings, const std::string& isa,
                                           int threads) {
  static const BackendRegistry kBackends({cpu::backend_entry(), opencl::backend_entry()});
  BackendRequest request;
  request.backend = test_backend_name();
  request.isa = isa;
  request.threads = threads;
  // One program for all tests; tests/statistical/backends compares it with the others.
  request.specialised = false;
  return kBackends.make(request, {std::make_shared<const FlatScene>(scene), derived, settings});
}

}  // namespace kiloband::test
