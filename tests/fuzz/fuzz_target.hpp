// The fuzz targets: each feeds bytes to one reader of the program and uses what it read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace kiloband::fuzz {

/// A target takes any bytes and returns. A file that is refused is fine; every exception that leaves a target
/// is a finding, as are signals, reports of sanitizers, and what takes too long or too much memory.
struct Target {
  const char* name;  // of its folders corpus/NAME and regressions/NAME
  void (*run)(std::string_view bytes);
};

/// All targets.
std::span<const Target> targets();

void scene(std::string_view bytes);
void obj(std::string_view bytes);
void ply(std::string_view bytes);
void stl(std::string_view bytes);
void serialized(std::string_view bytes);
void spectrum(std::string_view bytes);
void absorption(std::string_view bytes);
void optical_constants(std::string_view bytes);
void responses(std::string_view bytes);
void plume(std::string_view bytes);
void bands(std::string_view bytes);
void names(std::string_view bytes);
void camera(std::string_view bytes);
void exr_cube(std::string_view bytes);
void envi_cube(std::string_view bytes);
void spectral_image(std::string_view bytes);
void image_header(std::string_view bytes);
void picture(std::string_view bytes);
void checkpoint(std::string_view bytes);
void viewer_requests(std::string_view bytes);

/// Runs `use`; the errors of users and machines (InputError, DeviceError) are what a reader may end with.
/// returns whether there was none
bool accept_or_refuse(const std::function<void()>& use);

/// How often `use` has ended without an error: what a corpus is good for.
std::size_t accepted_uses();

/// A file of this process with these bytes, for readers that take a path.
/// The next file of the same name replaces it.
std::filesystem::path scratch_file(const std::string& name, std::string_view bytes);
/// The folder of the scratch files.
const std::filesystem::path& scratch_folder();

/// throws std::logic_error  what: a promise that a reader breaks
void promise(bool kept, const char* what);

}  // namespace kiloband::fuzz
