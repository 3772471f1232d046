// Renders a scene given as text and hands back its statistics: what the statistical tests are written with.
// Test bodies name no backend: their programs are registered once per backend.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "film/spectral_film.hpp"
#include "render/backend.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"

namespace kiloband::test {

struct RenderSpec {
  std::string xml;                        // a whole <scene>; its film gives the size
  std::filesystem::path directory = ".";  // where its file names start
  std::string bands = "500:600:4";
  std::string guide;  // empty: the bands
  uint64_t spp = 64;
  SamplingSettings sampling;  // replicates: wanted
  std::string isa = "auto";   // of the CPU backend, as the next: auto, sse4, avx2, avx512
  int threads = 0;
  std::vector<std::pair<std::string, Spectrum>> responses;
  bool held = false;
};

/// Values in W m^-2 sr^-1. Channels come first, then the responses.
struct RenderResult {
  FlatScene scene;
  uint32_t width = 0, height = 0;
  std::size_t channels = 0;  // with responses
  uint32_t replicates = 0;
  std::vector<double> mean;                        // [pixel][channel]
  std::vector<double> variance;                    // of the mean, [pixel][channel]
  std::vector<double> tile_mean, tile_variance;    // held: [tile with samples][channel]
  std::vector<double> image_mean, image_variance;  // [channel]
  uint64_t invalid_samples = 0, vertices = 0, paths = 0;
  std::vector<std::string> diagnostics;

  double at(uint32_t x, uint32_t y, std::size_t channel) const {
    return mean[(std::size_t{y} * width + x) * channels + channel];
  }
};

/// What KILOBAND_TEST_BACKEND says: "cpu" (also when it is not set), "opencl" (the method that the backend
/// chooses), "opencl:pt", "opencl:dpept-path" or "opencl:dpept-batch".
std::string test_backend_name();

/// A scene that is read and compiled once for several renders, with the bits that each would have on its own.
/// throws what reading, flattening and rendering throw
class PreparedRender {
 public:
  explicit PreparedRender(RenderSpec spec);
  /// The renders that follow are by the sensor of another <scene>: of the same kind, film and filter.
  void look_as(const std::string& xml);
  RenderResult render(SamplingSettings sampling) const;
  RenderResult render() const { return render(spec_.sampling); }

 private:
  RenderSpec spec_;
  std::vector<std::string> diagnostics_;
  std::shared_ptr<FlatScene> scene_;
  DerivedChannels derived_;
};

/// A scene that is rendered once.
RenderResult render(const RenderSpec& spec);

/// |value - expected| in standard errors; infinite if the error is 0 and they differ by more
/// than 1e-5 relative.
double z_score(double value, double expected, double variance);

/// Two-sided critical |t| for `tests` simultaneous tests at family-wise rate alpha
/// (Sidak) with R - 1 degrees of freedom.
double critical_t(double alpha, std::size_t tests, uint32_t replicates);

}  // namespace kiloband::test
