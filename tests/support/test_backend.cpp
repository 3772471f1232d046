#include "tests/support/test_backend.hpp"

#include <cstdlib>
#include <stdexcept>

#include "src_cpu/cpu_backend.hpp"
#include "src_gpu/opencl_backend.hpp"

namespace kiloband::test {
namespace {

Isa isa_of(const std::string& name) {
  if (name == "sse4") return Isa::kSse4;
  if (name == "avx2") return Isa::kAvx2;
  if (name == "avx512") return Isa::kAvx512;
  return Isa::kAuto;
}

}  // namespace

std::string test_backend_name() {
  const char* name = std::getenv("KILOBAND_TEST_BACKEND");
  return name && *name ? name : "cpu";
}

std::unique_ptr<Backend> make_test_backend(const FlatScene& scene, const DerivedChannels& derived,
                                           const SamplingSettings& settings, const std::string& isa,
                                           int threads) {
  const std::string name = test_backend_name();
  if (name == "cpu")
    return make_cpu_backend(std::make_shared<const FlatScene>(scene), derived, settings,
                            {isa_of(isa), threads});
  const std::string prefix = "opencl:";
  OpenclOptions options;
  if (name.starts_with(prefix)) options.method = gpu::find_method(name.substr(prefix.size()));
  if (name != "opencl" && !options.method)
    throw std::runtime_error("KILOBAND_TEST_BACKEND=" + name + ": no such backend");
  // One program for all tests; tests/statistical/backends compares it with the others.
  options.specialised = false;
  return make_opencl_backend(std::make_shared<const FlatScene>(scene), derived, settings, options);
}

}  // namespace kiloband::test
