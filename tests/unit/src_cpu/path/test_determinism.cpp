// What a render must not depend on: threads, the part of the film, how its samples are divided; and what an
// instruction set may change.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "room_scene.hpp"
#include "scene/read/reader.hpp"
#include "src_cpu/cpu_backend.hpp"

namespace kiloband::test::test_determinism {

using namespace cpu;
namespace {

constexpr WavelengthMode kModes[] = {WavelengthMode::kShared, WavelengthMode::kPerPath};
constexpr SamplerType kSamplers[] = {SamplerType::kSobol, SamplerType::kIndependent};

TEST(Determinism, AnyNumberOfThreadsGivesTheSameBits) {
  for (const WavelengthMode mode : kModes) {
    RenderSpec spec = room_spec({80, 48});  // six blocks, two of them narrow, two low
    spec.sampling.wavelengths = mode;
    const RenderResult one = render(spec);
    EXPECT_GT(one.image_mean[0], 0);
    for (const int threads : {2, 3}) {
      spec.threads = threads;
      const RenderResult more = render(spec);
      EXPECT_EQ(one.mean, more.mean) << threads;
      EXPECT_EQ(one.variance, more.variance) << threads;
      EXPECT_EQ(one.image_mean, more.image_mean) << threads;
      EXPECT_EQ(one.image_variance, more.image_variance) << threads;
      EXPECT_EQ(one.vertices, more.vertices);
    }
  }
}

TEST(Determinism, SeedsDiffer) {
  RenderSpec spec = room_spec({16, 16});
  const RenderResult first = render(spec);
  spec.sampling.seed = 6;
  EXPECT_NE(first.mean, render(spec).mean);
}

/// How many values of a crop of the film differ from those of all of it. more: what stands in the room besides
std::size_t different_in_crop(WavelengthMode mode, SamplerType sampler, const std::string& more) {
  constexpr FilmSize kWhole{80, 48}, kCrop{80, 48, 21, 13, 37, 22};  // parts of four blocks
  const auto render_room = [&](const FilmSize& size) {
    RenderSpec spec = room_spec(size);
    spec.xml.insert(spec.xml.rfind("</scene>"), more);
    spec.sampling.wavelengths = mode;
    spec.sampling.sampler = sampler;
    return render(spec);
  };
  const RenderResult whole = render_room(kWhole), crop = render_room(kCrop);
  EXPECT_EQ(crop.width, kCrop.crop_width);
  std::size_t different = 0;
  for (uint32_t y = 0; y < crop.height; ++y)
    for (uint32_t x = 0; x < crop.width; ++x)
      for (std::size_t c = 0; c < crop.channels; ++c)
        different += crop.at(x, y, c) != whole.at(x + kCrop.crop_x, y + kCrop.crop_y, c);
  return different;
}

TEST(Determinism, CropsRenderThePixelsOfTheFullFilm) {
  const std::string gases = gas("atmosphere", "450:0.1, 650:0.3", "1500") +
                            ball("0.2 0.1 0.3", "0.5", bsdf("null") + gas("interior", "450:2, 650:0.5"));
  for (const WavelengthMode mode : kModes)
    for (const SamplerType sampler : kSamplers)
      for (const std::string& more : {std::string(), gases})
        EXPECT_EQ(different_in_crop(mode, sampler, more), 0u)
            << "mode " << static_cast<int>(mode) << ", sampler " << static_cast<int>(sampler)
            << (more.empty() ? "" : ", gas");
}

/// A film of the room that holds sums, rendered in the given numbers of samples per replicate,
/// one pass after the other.
std::vector<float> render_in_passes(const std::vector<uint32_t>& passes, SamplingSettings sampling) {
  const SceneDescription description = read_scene_text(room_spec({40, 40}).xml, "test.xml", ".", {});
  const auto scene = compile_scene(description, {parse_channels("500:600:4"), {}, {}});
  sampling.replicates = 4;
  const auto backend = cpu::make_backend(scene, {}, sampling, {Isa::kAuto, 1});
  FilmOptions options{4, 4, true, true};
  options.sums = backend->sum_rule();
  SpectralFilm film({0, 0, 40, 40}, options);
  const std::vector<uint32_t> blocks = film.all_blocks();
  uint32_t first = 0;
  for (const uint32_t count : passes) {
    for (uint32_t r = 0; r < 4; ++r) backend->render(film, {r, first, count}, blocks, false, {});
    first += count;
  }
  std::vector<float> values(2 * std::size_t{40} * 40 * 4);
  for (uint32_t y = 0; y < 40; ++y) {
    EXPECT_EQ(film.samples(0, y), 4u * first);
    film.row(y, std::span(values).subspan(y * 160, 160), std::span(values).subspan(6400 + y * 160, 160));
  }
  return values;
}

TEST(Determinism, AnExtendedRenderHasTheBitsOfOneInOneGo) {
  for (const WavelengthMode mode : kModes) {
    for (const SamplerType sampler : kSamplers) {
      SamplingSettings sampling;
      sampling.wavelengths = mode;
      sampling.sampler = sampler;
      EXPECT_EQ(render_in_passes({7}, sampling), render_in_passes({4, 1, 2}, sampling));
    }
  }
  EXPECT_EQ(render_in_passes({70}, {}), render_in_passes({40, 24, 1, 5}, {}));  // over a chunk's bound
}

/// Hits of other code paths differ in their last bits, and so does all that follows; now and then a path
/// takes another turn. Equal random numbers keep nearly all pixels the same: a systematic difference would
/// show in every pixel.
TEST(Determinism, InstructionSetsAgree) {
  std::vector<Isa> sets{Isa::kSse4, Isa::kAvx2, Isa::kAvx512};
  std::erase_if(sets, [](Isa isa) { return !is_available(isa); });
  if (sets.size() < 2) GTEST_SKIP() << "this machine and this build have one instruction set in common";
  RenderSpec spec = room_spec({48, 48});
  spec.isa = to_string(sets[0]);
  const RenderResult baseline = render(spec);
  for (std::size_t set = 1; set < sets.size(); ++set) {
    spec.isa = to_string(sets[set]);
    const RenderResult other = render(spec);
    std::size_t different = 0;
    for (std::size_t i = 0; i < other.mean.size(); ++i) {
      different += std::abs(other.mean[i] - baseline.mean[i]) > 1e-4 * std::abs(baseline.mean[i]);
    }
    EXPECT_LT(static_cast<double>(different), 0.03 * static_cast<double>(other.mean.size())) << spec.isa;
    for (std::size_t c = 0; c < other.channels; ++c) {
      const double error = std::sqrt(baseline.image_variance[c]);
      EXPECT_NEAR(other.image_mean[c], baseline.image_mean[c], 0.1 * error) << spec.isa << ", channel " << c;
    }
  }
}

}  // namespace
}  // namespace kiloband::test::test_determinism
