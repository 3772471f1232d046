// A context on the first device, and a cache folder that vanishes with the test.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/temporary_folder.hpp"
#include "src_gpu/device/program.hpp"

namespace kiloband::opencl::test {

/// POCL_CACHE_DIR is a folder of this process until it ends. To hand out a binary PoCL 3.1 walks through all
/// files of the program twice, to measure and to copy: where another process runs the same program out of the
/// same folder and adds one in between, it writes past the end or keeps half a binary.
inline void take_own_pocl_folder() {
  static const ScratchFolder kFolder("kiloband_gpu_host_pocl");
  setenv("POCL_CACHE_DIR", kFolder.path().c_str(), 1);
}

/// XDG_CACHE_HOME is this folder while the object lives.
class CacheFolder {
 public:
  CacheFolder() {
    take_own_pocl_folder();
    list_devices();  // PoCL chooses the folder of its own cache now: one that stays
    const char* value = std::getenv("XDG_CACHE_HOME");
    if (value) before_ = value;
    path_ = make_temporary_folder("kiloband_gpu_host");
    setenv("XDG_CACHE_HOME", path_.c_str(), 1);
  }
  ~CacheFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
    before_.empty() ? unsetenv("XDG_CACHE_HOME") : setenv("XDG_CACHE_HOME", before_.c_str(), 1);
  }
  CacheFolder(const CacheFolder&) = delete;
  CacheFolder& operator=(const CacheFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::string before_;
};

class GpuTest : public ::testing::Test {
 protected:
  CacheFolder cache_;
  DeviceContext context_{select_device(std::nullopt), {true}};
  DeviceMemory memory_{context_};

  /// A program of this one text.
  Program build(const std::string& text, bool disk_cache = false) {
    return build_program(context_, {{"kernels/test.cl", text}}, "kernels/test.cl", {{}, disk_cache});
  }
};

/// what() of the exception of this type that `call` throws; fails the test where it throws none.
template <class Error, class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  ADD_FAILURE() << "no exception";
  return {};
}

}  // namespace kiloband::opencl::test
