// Sums of replicates are functions of the samples: however a render is cut into parts, its bits are those of
// one that was rendered at one go, and those of a film that keeps means alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

#include "backend_images.hpp"
#include "src_gpu/path/round_plan.hpp"

namespace kiloband::test::parts_test {
namespace {

using Parts = std::vector<uint32_t>;

constexpr uint32_t kReplicates = 2, kSamples = 67;  // over all chunks: 64 on the CPU, 16 with PoCL
/// Several sizes, on and off the bounds of chunks.
const std::vector<Parts> kCuts{{67}, {1, 1, 2, 4, 24, 35}, {16, 48, 3}, {64, 1, 1, 1}, {65, 2}};

/// A film that holds sums, rendered part by part.
class GrowingFilm {
 public:
  GrowingFilm(Backend& backend, const PixelRect& rect, uint32_t samples)
      : backend_(backend),
        samples_(samples),
        film_(rect, options(backend, samples)),
        blocks_(film_.all_blocks()) {}

  /// The next samples of a replicate, of all blocks.
  void add(uint32_t replicate, uint32_t count) { add_to(blocks_, replicate, count); }
  void add_to(const std::vector<uint32_t>& blocks, uint32_t replicate, uint32_t count) {
    const std::atomic<bool> stop{false};
    backend_.render(film_, {replicate, film_.attempted(replicate, blocks[0]), count}, blocks, stop, {});
  }
  SpectralFilm& film() { return film_; }

  /// All means; every pixel has all samples by now.
  std::vector<float> means() {
    std::vector<float> means, mean(film_.options().channels);
    for (uint32_t r = 0; r < kReplicates; ++r) {
      for (std::size_t p = 0; p < film_.rect().pixels(); ++p) {
        film_.replicate_mean(r, p, mean);
        means.insert(means.end(), mean.begin(), mean.end());
        EXPECT_EQ(film_.replicate_samples(r, p), samples_);
      }
    }
    return means;
  }

 private:
  static FilmOptions options(const Backend& backend, uint32_t samples) {
    FilmOptions options{backend.film_scale().size(), kReplicates, true, true};
    options.sums = backend.sum_rule();
    options.most_samples = samples;
    return options;
  }

  Backend& backend_;
  uint32_t samples_;
  SpectralFilm film_;
  std::vector<uint32_t> blocks_;
};

/// All means of a film after parts of these sizes.
std::vector<float> in_parts(Backend& backend, const PixelRect& rect, const Parts& parts) {
  GrowingFilm growing(backend, rect, std::accumulate(parts.begin(), parts.end(), 0u));
  for (uint32_t r = 0; r < kReplicates; ++r)
    for (const uint32_t count : parts) growing.add(r, count);
  return growing.means();
}

std::size_t different_bits(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    count += std::bit_cast<uint32_t>(a[i]) != std::bit_cast<uint32_t>(b[i]);
  return count;
}

class SumsInParts : public testing::Test {
 protected:
  /// Two blocks of the diffuse scene, both clipped.
  std::unique_ptr<Backend> backend(const std::string& name, SamplerType sampler, WavelengthMode mode,
                                   const DerivedChannels& derived = {}) {
    return make_zoo_backend(name, scene_, derived, {mode, sampler, 3, kReplicates});
  }

  ZooFolder folder_;
  const FlatScene scene_ = folder_.flatten(scene_zoo().front());
  const PixelRect rect_{28, 3, 4, 3};
};

TEST_F(SumsInParts, OfAnySizeGiveTheBitsOfOneDelivery) {
  for (const std::string name : {"cpu", "opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"}) {
    for (const SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
      const WavelengthMode mode =
          sampler == SamplerType::kSobol ? WavelengthMode::kShared : WavelengthMode::kPerPath;
      const auto renderer = backend(name, sampler, mode);
      const std::vector<float> at_once = render_part(*renderer, rect_, kReplicates, kSamples).means;
      for (const Parts& parts : kCuts)
        EXPECT_EQ(different_bits(at_once, in_parts(*renderer, rect_, parts)), 0u)
            << name << ", parts " << testing::PrintToString(parts);
      const Parts fewer{3, 4};  // of one chunk
      EXPECT_EQ(different_bits(render_part(*renderer, rect_, kReplicates, 7).means,
                               in_parts(*renderer, rect_, fewer)),
                0u)
          << name;
    }
  }
}

/// A part that is stopped after its first round: the chunk is full, and stays open, as checkpoints have it, which keep no closed sums of so
/// few samples. What follows gives the bits of one delivery.
TEST_F(SumsInParts, OfAStoppedPartAreOpen) {
  const PixelRect large{28, 3, 40, 38};  // rounds of fewer pixels may be one
  for (const std::string name : {"opencl:dpept-batch", "opencl:dpept-path"}) {
    const auto renderer = backend(name, SamplerType::kSobol, WavelengthMode::kShared);
    GrowingFilm growing(*renderer, large, 40);
    SpectralFilm& film = growing.film();
    const std::vector<uint32_t> blocks = film.all_blocks();
    std::atomic<bool> stop{false};
    renderer->render(film, {0, 0, 40}, blocks, stop, [&](uint64_t) { stop = true; });
    const uint32_t done = film.attempted(0, 0);
    ASSERT_EQ(done, renderer->sum_rule().chunk) << name;
    float brightest = 0;
    for (std::size_t p = 0; p < large.pixels(); ++p) {
      const PixelSumsView sums = std::as_const(film).pixel_sums(0, p);
      EXPECT_EQ(std::ranges::count(sums.closed, ClosedSum{0}), std::ranges::ssize(sums.closed)) << name;
      brightest = std::max(brightest, std::ranges::max(sums.open));
    }
    EXPECT_GT(brightest, 0) << name;
    growing.add(0, 40 - done);
    growing.add(1, 40);
    EXPECT_EQ(different_bits(render_part(*renderer, large, kReplicates, 40).means, growing.means()), 0u)
        << name;
  }
}

const std::vector<std::string> kDeviceMethods{"opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"};

/// Were sums taken to the device?
bool has_loaded_sums(const Backend& backend) {
  return backend.statistics().kernel_seconds.contains("film_unpack");
}

/// A film that is gone on with at once: the device has its sums.
TEST_F(SumsInParts, StayOnTheDevice) {
  for (const std::string& name : kDeviceMethods) {
    const auto renderer = backend(name, SamplerType::kSobol, WavelengthMode::kShared);
    in_parts(*renderer, rect_, Parts(20, 1));  // of one size: others may need memory for more rounds
    EXPECT_FALSE(has_loaded_sums(*renderer)) << name;
  }
}

/// ... and not those of another film, of another replicate or of other blocks, nor those of a film that somebody else has touched, nor of one
/// whose memory on the device something else has had.
TEST_F(SumsInParts, ComeFromTheFilmWhereTheDeviceHasOthers) {
  for (const std::string& name : kDeviceMethods) {
    const PixelRect two_blocks{28, 3, 8, 3};
    const auto make = [&] { return backend(name, SamplerType::kSobol, WavelengthMode::kShared); };
    const std::vector<float> at_once = render_part(*make(), two_blocks, kReplicates, 9).means;
    using Between = std::function<void(Backend & renderer, GrowingFilm & film, GrowingFilm & other)>;
    const std::vector<std::pair<const char*, Between>> cases{
        {"another film", [](Backend&, GrowingFilm&, GrowingFilm& other) { other.add(0, 3); }},
        {"another replicate", [](Backend&, GrowingFilm& film, GrowingFilm&) { film.add(1, 3); }},
        {"a block of them",
         [](Backend&, GrowingFilm& film, GrowingFilm&) {
           film.add_to({1}, 0, 2);
           film.add_to({0}, 0, 2);
         }},
        {"somebody else",
         [](Backend&, GrowingFilm& film, GrowingFilm&) {
           const PixelSums sums = film.film().pixel_sums(0, 0);
           sums.open[0] += 0.0f;
         }},
        {"auxiliary images",
         [&](Backend& renderer, GrowingFilm&, GrowingFilm&) { renderer.auxiliary(two_blocks); }},
        {"means",
         [&](Backend& renderer, GrowingFilm&, GrowingFilm&) { render_part(renderer, two_blocks, 1, 2); }},
    };
    for (const auto& [what, between] : cases) {
      const auto renderer = make();
      GrowingFilm film(*renderer, two_blocks, 9), other(*renderer, two_blocks, 9);
      film.add(0, 4);
      between(*renderer, film, other);
      for (uint32_t r = 0; r < kReplicates; ++r) film.add(r, 9 - film.film().attempted(r, 0));
      EXPECT_TRUE(has_loaded_sums(*renderer)) << name << ", " << what;
      EXPECT_EQ(different_bits(at_once, film.means()), 0u) << name << ", " << what;
    }
  }
}

/// The film of all pixels does not fit: what the device has is of its last group. Nor is it of a small film once a large one came between.
TEST_F(SumsInParts, OfSeveralGroups) {
  const FlatScene scene = folder_.flatten(zoo_scene("crop_window"), "450:650:100");
  const PixelRect large = film_rect(scene), small{large.x0, large.y0, 3, 2};
  for (const std::string& name : kDeviceMethods) {
    std::size_t notes = 0;
    opencl::Options options;
    options.device_memory = uint64_t{600} << 10;
    options.sink = [&](const Diagnostic&) { ++notes; };
    const SamplingSettings settings{WavelengthMode::kShared, SamplerType::kSobol, 3, kReplicates};
    const auto whole = make_zoo_backend(name, scene, {}, settings);
    const auto renderer = make_zoo_backend(name, scene, {}, settings, options);
    GrowingFilm first(*renderer, small, 6), second(*renderer, large, 6);
    first.add(0, 2);
    second.add(0, 1);
    EXPECT_GT(notes, 0u) << "all pixels fit at once";
    for (uint32_t r = 0; r < kReplicates; ++r) {
      for (GrowingFilm* film : {&first, &second, &second})
        film->add(r, (6 - film->film().attempted(r, 0)) / (film == &second ? 2 : 1));
    }
    for (uint32_t r = 0; r < kReplicates; ++r) second.add(r, 6 - second.film().attempted(r, 0));
    EXPECT_EQ(different_bits(render_part(*whole, small, kReplicates, 6).means, first.means()), 0u) << name;
    EXPECT_EQ(different_bits(render_part(*whole, large, kReplicates, 6).means, second.means()), 0u) << name;
  }
}

/// The methods dpept keep the derived channels of whole rounds alone: parts that end there,
/// as SumRule::step says.
TEST_F(SumsInParts, WithDerivedChannelsEndWhereTheRuleSays) {
  for (const std::string name : {"cpu", "opencl:dpept-batch", "opencl:dpept-path", "opencl:pt"}) {
    const auto renderer =
        backend(name, SamplerType::kSobol, WavelengthMode::kShared, zoo_responses(scene_.channels));
    const uint32_t step = renderer->sum_rule().step;
    EXPECT_EQ(step, name.find("dpept") == std::string::npos ? 1u : 16u);
    const std::vector<float> at_once = render_part(*renderer, rect_, kReplicates, kSamples).means;
    for (const Parts& parts : {Parts{step, kSamples - step}, Parts{2 * step, step, kSamples - 3 * step}})
      EXPECT_EQ(different_bits(at_once, in_parts(*renderer, rect_, parts)), 0u)
          << name << ", parts " << testing::PrintToString(parts);
  }
}

/// Chunks as lists of samples, as rounds with these rules would add them, the open one at the end.
/// rounds  that may be one
std::vector<Parts> chunks_after(const Parts& parts, const SumRule& rule, uint32_t rounds = 1) {
  const uint32_t registers = opencl::samples_in_registers(false);
  std::vector<Parts> closed;
  Parts open;
  const auto close = [&] {
    if (!open.empty()) closed.push_back(open);
    open.clear();
  };
  uint32_t first = 0;
  for (const uint32_t count : parts) {
    for (const uint32_t end = first + count; first < end;) {
      const opencl::SampleCut cut = opencl::next_cut(first, end, rule, rounds);
      if (first > 0 && opencl::begins_chunk(first, rule)) close();
      EXPECT_TRUE(cut.open || open.empty());
      EXPECT_LE(cut.samples, cut.open ? registers : rounds * rule.period);
      for (const uint32_t last = first + cut.samples; first < last; ++first) {
        if (!cut.open && open.size() == registers) close();  // as kernels do
        open.push_back(first);
      }
      if (!cut.open) close();
    }
  }
  close();  // the mean has it all
  return closed;
}

TEST(SampleCuts, GiveTheChunksOfOneDelivery) {
  using opencl::Method, opencl::sum_rule_of;
  for (const uint32_t round : {1u, 5u, 16u, 32u, 33u, 40u, 64u}) {
    const SumRule rule = sum_rule_of(Method::kDpeptBatch, round, false);
    for (const uint32_t total : {1u, 16u, 31u, 32u, 64u, 65u, 150u}) {
      const std::vector<Parts> at_once = chunks_after({total}, rule);
      const Parts ones(total, 1);
      EXPECT_EQ(chunks_after(ones, rule), at_once) << round << ", " << total;
      EXPECT_EQ(chunks_after({total / 3, total - total / 3}, rule), at_once) << round << ", " << total;
      std::size_t beyond = 0;  // closed sums are there where they are needed
      for (const Parts& chunk : at_once) beyond += chunk.size();
      EXPECT_EQ(beyond, total);
      if (total <= rule.chunk) {
        EXPECT_EQ(at_once.size(), 1u);
        EXPECT_TRUE(opencl::next_cut(0, total, rule).open);
      }
    }
  }
  EXPECT_EQ(sum_rule_of(Method::kPt, 16, true), (SumRule{SumRule::Kind::kCompensated, 0, 1, 1}));
}

/// Where rounds may be one (opencl::rounds_as_one), however many: the same chunks.
TEST(SampleCuts, OfRoundsThatAreOneGiveTheSameChunks) {
  for (const uint32_t round : {32u, 64u, 96u}) {
    const SumRule rule = opencl::sum_rule_of(opencl::Method::kDpeptBatch, round, false);
    for (const uint32_t total : {1u, 32u, 64u, 96u, 97u, 640u, 1000u}) {
      const std::vector<Parts> alone = chunks_after({total}, rule);
      for (const uint32_t rounds : {2u, 3u, 1000u}) {
        EXPECT_EQ(chunks_after({total}, rule, rounds), alone) << round << ", " << total << ", " << rounds;
        EXPECT_EQ(chunks_after({total / 3, total - total / 3}, rule, rounds), alone)
            << round << ", " << total << ", " << rounds;
      }
    }
  }
}

}  // namespace
}  // namespace kiloband::test::parts_test
