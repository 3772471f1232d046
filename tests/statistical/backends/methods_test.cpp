// The three methods, general and specialised kernels, any pool and any device memory: one image.
//
// Same seed, same paths: the methods add the same numbers in the same order. Between methods a value may
// differ by rounding, 1e-5 relative; runs of one method are equal bit by bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "backend_images.hpp"
#include "tests/support/effort.hpp"

namespace kiloband::test::methods_test {
namespace {

constexpr uint32_t kReplicates = 2, kSamples = 2;

SamplingSettings settings_of(WavelengthMode wavelengths, uint64_t seed = 5) {
  return {wavelengths, SamplerType::kSobol, seed, kReplicates};
}

opencl::Options general() {
  opencl::Options options;
  options.specialised = false;
  return options;
}

/// What a pair of images comes to.
struct Difference {
  std::size_t bits = 0;  // values with different bits
  double relative = 0;   // largest, of the pixel's largest channel
};

Difference difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.means.size(), b.means.size());
  EXPECT_EQ(a.samples, b.samples);
  Difference d;
  for (std::size_t first = 0; first < a.means.size(); first += a.channels) {
    const double largest = *std::max_element(&a.means[first], &a.means[first] + a.channels);
    for (std::size_t i = first; i < first + a.channels; ++i) {
      if (std::bit_cast<uint32_t>(a.means[i]) == std::bit_cast<uint32_t>(b.means[i])) continue;
      ++d.bits;
      d.relative = std::max(d.relative, std::abs(double{a.means[i]} - b.means[i]) / largest);
    }
  }
  return d;
}

void expect_same_bits(const Image& a, const Image& b, const std::string& what) {
  const Difference d = difference(a, b);
  EXPECT_EQ(d.bits, 0u) << what << ": " << d.relative << " relative";
}

void expect_rounding(const Image& a, const Image& b, const std::string& what) {
  const Difference d = difference(a, b);
  EXPECT_LE(d.relative, 1e-5) << what << ": " << d.bits << " of " << a.means.size() << " values differ";
}

class Methods : public testing::Test {
 protected:
  Image image(const std::string& method, const FlatScene& scene, const DerivedChannels& derived,
              WavelengthMode mode, const opencl::Options& options = general()) {
    return render_image(*make_zoo_backend(method, scene, derived, settings_of(mode), options), scene,
                        kReplicates, kSamples);
  }

  void compare_methods(const FlatScene& scene, const DerivedChannels& derived, WavelengthMode mode,
                       const std::string& what,
                       const std::vector<std::string>& others = {"dpept-path", "pt"}) {
    const Image batch = image("opencl:dpept-batch", scene, derived, mode);
    EXPECT_GT(*std::ranges::max_element(batch.means), 0) << what;
    for (const std::string& other : others)
      expect_rounding(batch, image("opencl:" + other, scene, derived, mode), what + ", " + other);
  }

  ZooFolder folder_;
};

/// Of the other two methods one and the other by turns; with KILOBAND_THOROUGH both. (Statistics has every scene and method.)
TEST_F(Methods, AgreeOnEveryScene) {
  std::size_t turn = 0;
  for (const ZooScene& zoo : scene_zoo()) {
    const WavelengthMode mode = turn % 2 == 0 ? WavelengthMode::kShared : WavelengthMode::kPerPath;
    std::vector<std::string> others{turn % 4 < 2 ? "pt" : "dpept-path"};
    if (thorough()) others = {"dpept-path", "pt"};
    compare_methods(folder_.flatten(zoo), {}, mode, zoo.name, others);
    ++turn;
  }
}

TEST_F(Methods, AgreeForAnyNumberOfChannelsWithResponses) {
  const struct {
    const char* scene;
    const char* bands;
    WavelengthMode mode;
  } cases[] = {{"metals", "450:650:1", WavelengthMode::kShared},
               {"pictures", "450:650:7", WavelengthMode::kPerPath},
               {"prism", "450:650:33", WavelengthMode::kShared},
               {"plastics", "450:650:100", WavelengthMode::kShared}};
  for (const auto& c : cases) {
    const FlatScene scene = folder_.flatten(zoo_scene(c.scene), c.bands);
    compare_methods(scene, zoo_responses(scene.channels), c.mode, std::string(c.scene) + " " + c.bands);
  }
}

/// The kernels are the same text with parts left out, without contraction: the same bits. By default scenes
/// that together need every feature; with KILOBAND_THOROUGH set, every scene and method
/// (minutes of kernel builds).
TEST_F(Methods, SpecialisedKernelsGiveTheSameBits) {
  std::vector<std::string> scenes{"diffuse_room", "crop_window",       "hidden_emitters",
                                  "thermal",      "temperature_field", "plumes"};
  std::vector<std::string> methods{"opencl:dpept-batch"};
  if (thorough()) {
    scenes.clear();
    for (const ZooScene& zoo : scene_zoo()) scenes.push_back(zoo.name);
    methods.assign(kOpenclMethods.begin(), kOpenclMethods.end());
  }
  for (const std::string& name : scenes) {
    const FlatScene scene = folder_.flatten(zoo_scene(name));
    for (const std::string& method : methods) {
      expect_same_bits(image(method, scene, {}, WavelengthMode::kShared),
                       image(method, scene, {}, WavelengthMode::kShared, {}), name + ", " + method);
    }
  }
}

TEST_F(Methods, SameSeedSameBitsWhateverThePool) {
  for (const std::string& method : kOpenclMethods) {
    const FlatScene scene = folder_.flatten(zoo_scene("crop_window"));
    const Image first = image(method, scene, {}, WavelengthMode::kShared);
    expect_same_bits(first, image(method, scene, {}, WavelengthMode::kShared), method + ", again");
    for (const uint32_t slots : {64u, 100u, 4096u}) {
      opencl::Options options = general();
      options.tuning.pool_slots = slots;
      expect_same_bits(first, image(method, scene, {}, WavelengthMode::kShared, options),
                       method + ", " + std::to_string(slots) + " slots");
    }
    opencl::Options tuned = general();
    tuned.tuning = {512, 2000, 32, 128};
    expect_same_bits(first, image(method, scene, {}, WavelengthMode::kShared, tuned), method + ", tuned");
  }
}

/// Several groups of pixels, rounds that do not fit the arena and are split, down to pools of a few paths.
TEST_F(Methods, SmallDeviceMemoryGivesTheSameBits) {
  const FlatScene scene = folder_.flatten(zoo_scene("crop_window"), "450:650:100");
  for (const std::string& method : kOpenclMethods) {
    const Image first = image(method, scene, {}, WavelengthMode::kShared);
    for (const uint64_t kibibytes : {6000u, 1500u, 600u}) {
      std::vector<std::string> notes;
      opencl::Options options = general();
      options.device_memory = kibibytes << 10;
      options.sink = [&](const Diagnostic& d) { notes.push_back(d.to_string()); };
      expect_same_bits(first, image(method, scene, {}, WavelengthMode::kShared, options),
                       method + ", " + std::to_string(kibibytes) + " KiB");
      for (const std::string& note : notes) std::printf("%s: %s\n", method.c_str(), note.c_str());
    }
  }
}

TEST_F(Methods, ImageInPartsIsTheWhole) {
  const FlatScene scene = folder_.flatten(zoo_scene("crop_window"));
  const PixelRect whole = film_rect(scene);
  for (const std::string& method : kOpenclMethods) {
    const auto backend = make_zoo_backend(method, scene, {}, settings_of(WavelengthMode::kShared), general());
    const Image all = render_part(*backend, whole, kReplicates, kSamples);
    const uint32_t left = 13, top = 9;
    const PixelRect parts[] = {{whole.x0, whole.y0, left, whole.height},
                               {whole.x0 + left, whole.y0, whole.width - left, top},
                               {whole.x0 + left, whole.y0 + top, whole.width - left, whole.height - top}};
    for (const PixelRect& rect : parts) {
      const Image part = render_part(*backend, rect, kReplicates, kSamples);
      for (uint32_t r = 0; r < kReplicates; ++r) {
        for (std::size_t p = 0; p < part.pixels(); ++p) {
          const std::size_t x = rect.x0 - whole.x0 + p % rect.width, y = rect.y0 - whole.y0 + p / rect.width;
          for (std::size_t k = 0; k < all.channels; ++k)
            ASSERT_EQ(part.at(r, p, k), all.at(r, y * whole.width + x, k)) << method;
        }
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::methods_test
