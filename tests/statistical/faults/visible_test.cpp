// Every planted fault changes the image of a scene that has what it needs, on the backend that has it, and
// nothing else: equal seeds, so images without a fault are the same bits.
// 32 x 32 pixels, 2 replicates of 4 samples.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <ostream>
#include <string>

#include "tests/statistical/backends/backend_images.hpp"
#include "tests/support/zoo/scene_zoo.hpp"
#include "validation/faults/selection.hpp"
#include "validation/faults/table.hpp"

namespace kiloband::test {
namespace {

using faults::FaultScope;
using faults::PlantedFault;

constexpr uint32_t kReplicates = 2, kSamples = 4;

/// The scene is read with the fault as well: it may be in there.
Image render_zoo(const std::string& backend, const std::string& scene) {
  static const ZooFolder folder;
  const FlatScene flat = folder.flatten(zoo_scene(scene));
  SamplingSettings settings;
  settings.seed = 2024;
  settings.replicates = kReplicates;
  // Programs with what the scene needs alone: every fault is a program of its own, and compiles in seconds.
  const auto renderer = make_zoo_backend(backend, flat, {}, settings, {.specialised = true});
  return render_image(*renderer, flat, kReplicates, kSamples);
}

const Image& clean_image(const std::string& backend, const std::string& scene) {
  static std::map<std::string, Image> images;
  const auto [place, is_new] = images.try_emplace(backend + " " + scene);
  if (is_new) place->second = render_zoo(backend, scene);
  return place->second;
}

/// Values that are not the same bits.
std::size_t differing(const Image& a, const Image& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.means.size(); ++i) count += a.means[i] != b.means[i];
  return count;
}

double total(const Image& image) {
  double sum = 0;
  for (const float value : image.means) sum += value;
  return sum;
}

struct Planted {
  std::string backend;    // that renders
  std::string selection;  // "cpu:missing-cosine"
  const PlantedFault* fault;
};

void PrintTo(const Planted& planted, std::ostream* out) {
  *out << planted.selection << " on " << planted.backend;
}

/// One after the other of every backend that has it.
std::vector<Planted> all_planted() {
  std::vector<Planted> all;
  const std::string opencl = "opencl:dpept-batch";
  for (const PlantedFault& fault : faults::planted_faults()) {
    const std::string name(fault.name);
    if (fault.where & faults::kCpu) all.push_back({"cpu", "cpu:" + name, &fault});
    if (fault.where & faults::kOpencl) all.push_back({opencl, "opencl:" + name, &fault});
    if (fault.where & faults::kShared) {
      all.push_back({"cpu", "shared:" + name, &fault});
      all.push_back({opencl, "shared:" + name, &fault});
    }
  }
  return all;
}

class Visible : public testing::TestWithParam<Planted> {};

TEST_P(Visible, ChangesTheImage) {
  const Planted& planted = GetParam();
  const std::string scene(planted.fault->zoo_scene);
  const Image& clean = clean_image(planted.backend, scene);
  Image faulty;
  {
    const FaultScope fault(planted.selection);
    faulty = render_zoo(planted.backend, scene);
  }
  ASSERT_EQ(faulty.means.size(), clean.means.size());
  EXPECT_GT(differing(faulty, clean), 0u) << scene;
  EXPECT_EQ(faulty.invalid_samples, 0u) << "noticed before any statistics";
  RecordProperty("values_changed", static_cast<int>(differing(faulty, clean)));
  RecordProperty("image_mean_change", std::to_string(total(faulty) / total(clean) - 1));
}

std::string test_name(const testing::TestParamInfo<Planted>& info) {
  std::string name = info.param.selection + "_" + info.param.backend.substr(0, 3);
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Faults, Visible, testing::ValuesIn(all_planted()), test_name);

/// A fault of one backend leaves the other alone, and one that was selected before leaves nothing behind.
TEST(FaultPlaces, AreSeparate) {
  for (const std::string backend : {"cpu", "opencl:dpept-batch"}) {
    const Image& clean = clean_image(backend, "diffuse_room");
    const std::string other = backend == "cpu" ? "opencl" : "cpu";
    for (const PlantedFault& fault : faults::planted_faults()) {
      if (fault.zoo_scene != "diffuse_room" || fault.where != faults::kBoth) continue;
      const FaultScope scope(other + ":" + std::string(fault.name));
      EXPECT_EQ(differing(render_zoo(backend, "diffuse_room"), clean), 0u)
          << backend << " with " << other << ":" << fault.name;
    }
    EXPECT_EQ(differing(render_zoo(backend, "diffuse_room"), clean), 0u);
  }
}

}  // namespace
}  // namespace kiloband::test
