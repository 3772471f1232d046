#include "tests/fuzz/fuzz_target.hpp"

#include <array>
#include <cstddef>
#include <stdexcept>

#include "base/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace kiloband::fuzz {
namespace {

const test::TemporaryFolder& folder() {
  static const test::TemporaryFolder kFolder;
  return kFolder;
}

constexpr std::array kTargets{
    Target{"scene", scene},
    Target{"obj", obj},
    Target{"ply", ply},
    Target{"stl", stl},
    Target{"serialized", serialized},
    Target{"spectrum", spectrum},
    Target{"absorption", absorption},
    Target{"optical_constants", optical_constants},
    Target{"responses", responses},
    Target{"plume", plume},
    Target{"bands", bands},
    Target{"names", names},
    Target{"camera", camera},
    Target{"exr_cube", exr_cube},
    Target{"envi_cube", envi_cube},
    Target{"spectral_image", spectral_image},
    Target{"image_header", image_header},
    Target{"picture", picture},
    Target{"checkpoint", checkpoint},
    Target{"viewer_requests", viewer_requests},
};

std::size_t accepted = 0;

}  // namespace

std::span<const Target> targets() {
  return kTargets;
}

bool accept_or_refuse(const std::function<void()>& use) {
  try {
    use();
  } catch (const InputError&) {
    return false;
  } catch (const DeviceError&) {
    return false;
  }
  ++accepted;
  return true;
}

std::size_t accepted_uses() {
  return accepted;
}

std::filesystem::path scratch_file(const std::string& name, std::string_view bytes) {
  return folder().write(name, std::string(bytes));
}

const std::filesystem::path& scratch_folder() {
  return folder().path();
}

void promise(bool kept, const char* what) {
  if (!kept) throw std::logic_error(what);
}

}  // namespace kiloband::fuzz
