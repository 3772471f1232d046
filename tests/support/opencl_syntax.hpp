// OpenCL C checked with clang, which needs no device.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace kiloband::test {

/// What clang says about a file as OpenCL C 1.2 for spir64, with all warnings as errors; empty if nothing.
/// Includes are rooted at kernels/ and src/.
inline std::string opencl_syntax(const std::filesystem::path& file, const std::string& options = "") {
  const TemporaryFolder folder;
  const std::string command =
      std::string(KILOBAND_CLANG) +
      " -x cl -cl-std=CL1.2 -target spir64 -Xclang -finclude-default-header -Wall -Wextra -Werror"
      " -fsyntax-only '-I" KILOBAND_SOURCE_DIR "/kernels' '-I" KILOBAND_SOURCE_DIR "/src' " +
      options + " '" + file.string() + "' 2> '" + (folder / "log").string() + "'";
  const int status = std::system(command.c_str());
  return status == 0 ? "" : folder.read("log") + "(status " + std::to_string(status) + ")";
}

/// The same of a kernel file: what a left-out feature reads is then an unused parameter.
inline std::string kernel_syntax(const std::filesystem::path& file, const std::string& options = "") {
  return opencl_syntax(file, "-Wno-unused-function -Wno-unused-parameter " + options);
}

}  // namespace kiloband::test
