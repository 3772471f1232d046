// Emission and responses that are narrower than a channel, down to 1e-4 of it, and data that end inside one: on OpenCL devices the very
// spectra, as on the CPU. Same seed, same wavelengths: what differs is rounding of the wavelengths at which a spectrum begins.
#include <gtest/gtest.h>

#include <cmath>

#include "backend_images.hpp"

namespace kiloband::test::narrow_spectra_test {
namespace {

constexpr uint32_t kReplicates = 2, kSamples = 32;

/// A plane before a constant light of this radiance.
FlatScene lit_plane(const ZooFolder& folder, const std::string& light, const std::string& bands) {
  const ZooScene zoo{
      "narrow",
      "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'><integer name='width' value='32'/>"
      "<integer name='height' value='32'/><rfilter type='box'/></film><transform name='to_world'>"
      "<lookat origin='0, 0, 3' target='0, 0, 0' up='0, 1, 0'/></transform></sensor>"
      "<shape type='rectangle'><bsdf type='diffuse'><spectrum name='reflectance' value='400:0.5, 1400:0.9'/></bsdf></shape>"
      "<emitter type='constant'>" +
          light + "</emitter></scene>"};
  return folder.flatten(zoo, bands);
}

/// Specialised kernels: what lines need is little.
std::vector<double> sums(const std::string& backend, const FlatScene& scene, const DerivedChannels& derived,
                         WavelengthMode mode) {
  const SamplingSettings settings{mode, SamplerType::kSobol, 3, kReplicates};
  const auto renderer = make_zoo_backend(backend, scene, derived, settings, {.specialised = true});
  const Image image = render_image(*renderer, scene, kReplicates, kSamples);
  std::vector<double> sums(image.channels, 0.0);
  for (std::size_t i = 0; i < image.means.size(); ++i) sums[i % image.channels] += image.means[i];
  return sums;
}

/// Sums over the image agree to 0.3 %: 65,536 samples, of which 6 or more meet the narrowest line, at wavelengths that are rounded to
/// 6e-8 of the channel, 6e-4 of the line.
void expect_the_same(const FlatScene& scene, const DerivedChannels& derived, WavelengthMode mode,
                     const std::string& what) {
  const std::vector<double> cpu = sums("cpu", scene, derived, mode);
  for (const std::string& method : kOpenclMethods) {
    const std::vector<double> device = sums(method, scene, derived, mode);
    ASSERT_EQ(device.size(), cpu.size());
    for (std::size_t k = 0; k < cpu.size(); ++k)
      EXPECT_NEAR(device[k], cpu[k], 3e-3 * cpu[k]) << what << ", " << method << ", channel " << k;
  }
  if (mode == WavelengthMode::kPerPath) {  // 64 shared wavelengths may all miss a line
    EXPECT_GT(cpu.front(), 0) << what;
    EXPECT_GT(cpu.back(), 0) << what;
  }
}

TEST(NarrowSpectra, AreThoseOfTheCpu) {
  const ZooFolder folder;
  DerivedChannels derived;
  derived.names = {"around 532 nm"};
  derived.responses = {RegularTable{531, 1, {0.5, 1, 0.5}, false}};
  for (const char* line : {"531.95:0, 532:1, 532.05:0", "531.55:1, 532.5:1", "500:1, 700:0.5"}) {
    const FlatScene scene = lit_plane(folder, std::string("<spectrum name='radiance' value='") + line + "'/>",
                                      "400-1400, 380-780");
    expect_the_same(scene, derived, WavelengthMode::kPerPath, line);
    expect_the_same(scene, derived, WavelengthMode::kShared, line + std::string(", shared"));
  }
}

}  // namespace
}  // namespace kiloband::test::narrow_spectra_test
