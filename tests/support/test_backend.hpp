// The backend that a test runs on: test programs are registered once per backend and name none themselves.
#pragma once

#include <memory>
#include <string>

#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"

namespace kiloband::test {

/// What KILOBAND_TEST_BACKEND says: "cpu" (also when it is not set), "opencl" (the method that the backend
/// chooses), "opencl:pt", "opencl:dpept-path" or "opencl:dpept-batch".
std::string test_backend_name();

/// isa, threads: of the CPU backend; OpenCL ignores them.
/// throws InputError  KILOBAND_TEST_BACKEND is no backend's name
std::unique_ptr<Backend> make_test_backend(const FlatScene& scene, const DerivedChannels& derived,
                                           const SamplingSettings& settings, const std::string& isa = "auto",
                                           int threads = 0);

}  // namespace kiloband::test
