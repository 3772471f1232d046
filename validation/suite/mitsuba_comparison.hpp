// Scenes that Mitsuba 3 renders, too, and the comparison of its images with ours.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "validation/suite/rendering.hpp"

namespace kiloband::validation {

/// A scene that both programs read; the film is kMitsubaSize pixels wide and high, with kMitsubaBands.
struct MitsubaCase {
  std::string name;            // "cornell_box"
  std::filesystem::path file;  // absolute
  uint32_t ours, theirs;       // samples per pixel and replicate in a thorough run
  std::string what;            // it shows
};
inline constexpr uint32_t kMitsubaSize = 32, kMitsubaReplicates = 32;
inline constexpr const char* kMitsubaBands = "400:700:8";

/// root: kiloband's source folder
std::vector<MitsubaCase> mitsuba_cases(const std::filesystem::path& root);

/// One scene on one backend.
struct MitsubaScene {
  std::string name, backend;
  bool passed = false;
  std::string failure;   // why it did not pass
  nlohmann::json entry;  // all that the results have of it; null: nothing

  /// "/detectable/typical" of the entry; NaN where there is no such number.
  double figure(const char* pointer) const;
};

/// The cubes STEM.r00.hdr ... of render_mitsuba.py.
/// throws InputError  one cannot be read, or has another size, other bands or another unit
stats::ReplicateImage read_mitsuba_cubes(const std::filesystem::path& stem, uint32_t samples);

/// Two independent estimators: all means, variances not. What is not finite or invalid has failed.
/// level: rate of false alarms of the whole comparison
/// throws std::logic_error  the images differ in shape
MitsubaScene compare_with_mitsuba(const MitsubaCase& c, const std::string& backend, const Rendering& ours,
                                  const stats::ReplicateImage& theirs, double level);

}  // namespace kiloband::validation
