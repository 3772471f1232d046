// Sums of replicates are functions of the samples: however a render is cut into parts, its bits are those of
// one that was rendered at one go, and those of a film that keeps means alone.
#include <gtest/gtest.h>

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

/// All means and their variances of a film that holds sums, after parts of these sizes.
std::vector<float> in_parts(Backend& backend, const PixelRect& rect, const Parts& parts) {
  FilmOptions options{backend.film_scale().size(), kReplicates, true, true};
  options.sums = backend.sum_rule();
  options.most_samples = std::accumulate(parts.begin(), parts.end(), 0u);
  SpectralFilm film(rect, options);
  std::vector<uint32_t> blocks(film.blocks().size());
  std::iota(blocks.begin(), blocks.end(), 0u);
  const std::atomic<bool> stop{false};
  for (uint32_t r = 0; r < kReplicates; ++r) {
    uint32_t first = 0;
    for (const uint32_t count : parts) {
      backend.render(film, {r, first, count}, blocks, stop, {});
      first += count;
    }
  }
  std::vector<float> means, mean(options.channels);
  for (uint32_t r = 0; r < kReplicates; ++r) {
    for (std::size_t p = 0; p < rect.pixels(); ++p) {
      film.replicate_mean(r, p, mean);
      means.insert(means.end(), mean.begin(), mean.end());
      EXPECT_EQ(film.replicate_samples(r, p), options.most_samples);
    }
  }
  return means;
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
