// The --stats file. Its names are a contract: scripts read them.
#pragma once

#include <filesystem>
#include <string>

#include "render/backend.hpp"
#include "render/session.hpp"

namespace kiloband {

/// What the session itself does not know.
struct RenderContext {
  SamplingSettings sampling;
  uint32_t width = 0, height = 0;
  std::size_t channels = 0;
  double setup_seconds = 0;
  std::vector<std::string> features;
};

/// "--spp", "--time", "--target-error" ...: the rule, as the user knows it.
const char* to_string(StopReason reason);

/// "relative error (RMS of the pixels over the image's mean): 2.3 % in the worst channel (400-410 nm), 1.1 % in the
/// median one; 2 channels without light are left out". Without errors it says that there are none.
std::string describe_errors(const RenderReport& report);

/// Pretty-printed JSON.
std::string statistics_json(const RenderContext& context, const RenderReport& report, const Backend& backend);
const char* to_string(WavelengthMode mode);
const char* to_string(SamplerType sampler);
/// Largest resident set of this process so far, bytes.
uint64_t peak_memory_bytes();

}  // namespace kiloband
