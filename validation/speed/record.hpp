// What `kiloband bench` writes: one flat list of measured numbers.
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kiloband::speed {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What was rendered, and how. 0 or empty: does not apply.
struct Setup {
  std::string scene;
  std::string backend;      // "cpu", "opencl", "mitsuba", "raysect"
  std::string method;       // "dpept-batch", "dpept-path", "pt"; of a peer: its variant
  std::string wavelengths;  // "shared", "per-path"
  std::string sampler;      // "sobol", "independent"
  std::string dispersion;   // at rough boundaries: "mis", "degrade"
  uint32_t channels = 0;
  uint32_t part = 0;  // channels that a path carries, where these are not all
  uint32_t width = 0, height = 0;
  uint32_t pool = 0;        // paths in flight that were asked for
  int depth = 0;            // --max-depth; 0: the scene's
  uint32_t replicates = 0;  // that an image's samples are dealt to
  uint64_t samples = 0;     // per pixel of an image
};

/// One number.
struct Record {
  std::string group;  // the case: "channels"
  Setup setup;
  std::string series;         // what else tells it from others: "pixel", "tile", "image", a stage
  double channel_nm = kNone;  // centre of the channel that it is about
  std::string quantity, unit;
  double value = kNone;
  double error = kNone;      // as error_kind says
  std::string error_kind;    // "standard error", "half range"
  uint32_t repetitions = 0;  // that value and error come from
  std::string note;          // why there is no value, or what it does not tell
  std::string command;       // that repeats it
};

/// A line for every record; fields with commas, quotes or line ends are quoted (RFC 4180); no number: empty.
std::string to_csv(const std::vector<Record>& records);

/// Fields that do not apply are left out; "value" and "error" are null where there is no number.
nlohmann::ordered_json to_json(const Record& record);

}  // namespace kiloband::speed
