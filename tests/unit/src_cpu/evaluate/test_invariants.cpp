// What must hold whatever the scene: channels do not see each other, modes agree,
// nothing is written where it must not be.
#include <cmath>
#include <cstring>
#include <limits>

#include "random_scene.hpp"

namespace kiloband::test::test_invariants {
namespace {

class Invariants : public EachIsa {};

/// The scene and paths with channel k alone. Where a path degrades to another channel,
/// that channel is not there.
std::pair<FlatScene, PathBuffer> channel_alone(const FlatScene& scene, const PathBuffer& paths,
                                               std::size_t k) {
  FlatScene one = scene;
  one.channels = {scene.channels[k]};
  one.channel_scale = {scene.channel_scale[k]};
  PathBuffer changed = paths;
  for (const SavedPath& path : changed.paths) {
    for (uint32_t i = path.first; i < path.first + path.count; ++i) {
      KbPathVertex& v = changed.entries[i];
      if (v.head & KB_VERTEX_DEGRADE)
        v.scatter1 = kb_channel_weight(kb_surviving_channel(v.scatter1) == k ? 0 : 1);
      i += kb_vertex_extensions(v.head);
    }
  }
  return {one, changed};
}

TEST_P(Invariants, ChannelAloneHasTheSameBits) {
  std::mt19937 random(3);
  const FlatScene scene = make_scene(make_channels(1000, Layout::kOverlapping, random), random);
  const PathBuffer paths = make_paths(scene, 200, random);
  const std::size_t stride = Evaluator(scene, {}, GetParam()).stride();
  for (bool shared : {true, false}) {
    const std::vector<float> all = evaluate(scene, {}, paths, GetParam(), 0.71875, shared);
    for (std::size_t k : {0u, 1u, 15u, 16u, 63u, 64u, 500u, 959u, 960u, 990u, 999u}) {
      const auto [one, changed] = channel_alone(scene, paths, k);
      const std::size_t one_stride = Evaluator(one, {}, GetParam()).stride();
      const std::vector<float> alone = evaluate(one, {}, changed, GetParam(), 0.71875, shared);
      for (std::size_t p = 0; p < paths.paths.size(); ++p) {
        ASSERT_EQ(kb_as_u32(all[p * stride + k]), kb_as_u32(alone[p * one_stride]))
            << "channel " << k << ", path " << p;
      }
    }
  }
}

TEST_P(Invariants, SharedEqualsPerPath) {
  // The modes differ in how tables are read (double, or float entries): by a few roundings per vertex.
  std::mt19937 random(4);
  const FlatScene scene = make_scene(make_channels(130, Layout::kRegular, random), random);
  const PathBuffer paths = make_paths(scene, 200, random);
  const DerivedChannels derived = make_responses();
  const std::vector<float> shared = evaluate(scene, derived, paths, GetParam(), 0.15625, true);
  const std::vector<float> per_path = evaluate(scene, derived, paths, GetParam(), 0.15625, false);
  for (std::size_t i = 0; i < shared.size(); ++i)
    ASSERT_NEAR(shared[i], per_path[i], 3e-6 * shared[i] + 1e-30) << i;
}

TEST_P(Invariants, OffsetsOfPathsAreTheirOwn) {
  std::mt19937 random(5);
  const FlatScene scene = make_scene(make_channels(70, Layout::kRegular, random), random);
  const PathBuffer paths = make_paths(scene, 50, random);
  Evaluator evaluator(scene, {}, GetParam());
  std::vector<float> sums(50 * evaluator.stride(), 0.0f), mu(50);
  for (float& m : mu) m = std::uniform_real_distribution<float>(0, 1)(random);
  evaluator.add_per_path(paths, mu, FollowingRows(evaluator, sums));
  for (std::size_t p = 0; p < 50; ++p) {
    const std::vector<float> own = evaluate(scene, {}, paths, GetParam(), mu[p], false);
    for (std::size_t k = 0; k < 70; ++k)
      ASSERT_EQ(own[p * evaluator.stride() + k], sums[p * evaluator.stride() + k]) << p << ' ' << k;
  }
}

TEST_P(Invariants, SumsAccumulateAndPaddingStaysZero) {
  std::mt19937 random(6);
  const FlatScene scene = make_scene(make_channels(65, Layout::kRegular, random), random);
  PathBuffer paths = make_paths(scene, 40, random);
  const DerivedChannels derived = make_responses();
  Evaluator evaluator(scene, derived, GetParam());
  EXPECT_EQ(evaluator.derived_offset(), 128u);
  EXPECT_EQ(evaluator.stride(), 192u);
  std::vector<float> sums(40 * evaluator.stride(), 0.0f);
  evaluator.add_shared(paths, 0.25, FollowingRows(evaluator, sums));
  const std::vector<float> once = sums;
  evaluator.add_shared(paths, 0.25, FollowingRows(evaluator, sums));
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const std::size_t column = i % evaluator.stride();
    const bool used = column < 65 || (column >= 128 && column < 132);
    ASSERT_EQ(sums[i], used ? 2 * once[i] : 0) << i;
  }
  // Reversed pixels: the same rows elsewhere.
  for (SavedPath& path : paths.paths) path.pixel = 39 - path.pixel;
  const std::vector<float> reversed = evaluate(scene, derived, paths, GetParam(), 0.25);
  for (std::size_t i = 0; i < once.size(); ++i) ASSERT_EQ(once[i], reversed[(39 - i / 192) * 192 + i % 192]);
}

/// Rows of a film: the same values, derived channels behind the channels, and nothing is touched beyond.
TEST_P(Invariants, PackedRowsGetTheBitsOfPaddedOnes) {
  constexpr float kUntouched = -7;
  for (const std::size_t channels : {1, 7, 8, 37, 65, 100, 131}) {
    std::mt19937 random(11);
    const FlatScene scene = make_scene(make_channels(channels, Layout::kRegular, random), random);
    const PathBuffer paths = make_paths(scene, 40, random);
    const DerivedChannels derived = make_responses();
    Evaluator evaluator(scene, derived, GetParam());
    const std::size_t used = channels + derived.names.size(), stride = used + 64;
    std::vector<float> packed(40 * stride, kUntouched), padded(40 * evaluator.stride(), 0.0f);
    std::vector<float*> rows;
    for (std::size_t p = 0; p < 40; ++p) {
      rows.push_back(&packed[p * stride]);
      std::fill_n(rows.back(), used, 0.0f);
    }
    evaluator.add_shared(paths, 0.25, {rows, true});
    evaluator.add_shared(paths, 0.25, FollowingRows(evaluator, padded));
    for (std::size_t i = 0; i < packed.size(); ++i) {
      const std::size_t pixel = i / stride, column = i % stride;
      const std::size_t there = column < channels ? column : evaluator.derived_offset() + column - channels;
      ASSERT_EQ(packed[i], column < used ? padded[pixel * evaluator.stride() + there] : kUntouched)
          << channels << ' ' << pixel << ' ' << column;
    }
  }
}

TEST_P(Invariants, InvalidWeightsStayInTheirPixel) {
  std::mt19937 random(8);
  const FlatScene scene = make_scene(make_channels(40, Layout::kRegular, random), random);
  const PathBuffer good = make_paths(scene, 60, random);
  PathBuffer bad = good;
  const float values[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(), -1e38f};
  for (std::size_t p = 0; p < 60; p += 2) {
    KbPathVertex& v = bad.entries[bad.paths[p].first];
    v.emit_weight = v.nee0 = v.nee1 = v.scatter0 = values[p / 2 % 4];
    if (!(v.head & KB_VERTEX_DEGRADE)) v.scatter1 = values[p / 2 % 4];
  }
  for (bool shared : {true, false}) {
    const std::vector<float> expected = evaluate(scene, {}, good, GetParam(), 0.5, shared);
    const std::vector<float> sums = evaluate(scene, {}, bad, GetParam(), 0.5, shared);
    const std::size_t stride = sums.size() / 60;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (i / stride % 2 == 1) {
        ASSERT_EQ(sums[i], expected[i]);
      }
    }
  }
}

/// Of the row of its light, the path behind an invalid one makes the channels of one group; the row's memory has been the other path's.
TEST_P(Invariants, PathsThatKeepOneChannelReadNoOthers) {
  std::mt19937 random(18);
  const FlatScene scene = make_scene(make_channels(200, Layout::kRegular, random), random);
  KbPathVertex invalid{}, keeps{}, lit{};
  invalid.head = KB_KIND_TWO_TERM | KB_VERTEX_NEE | KB_VERTEX_SCATTER;
  invalid.nee_row = 8;
  invalid.nee0 = invalid.nee1 = invalid.scatter0 = invalid.scatter1 = std::numeric_limits<float>::infinity();
  keeps.head = KB_KIND_SCALED | KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE;
  keeps.scatter0 = 1;
  keeps.scatter1 = kb_channel_weight(70);
  lit.head = KB_KIND_SCALED | KB_VERTEX_EMIT | KB_VERTEX_TEX_EMIT;
  lit.emit_weight = 1;
  const KbTextureSample sample{3, 0, 0.5f, 0.5f};
  PathBuffer paths;
  paths.entries = {invalid, keeps, lit, {}};
  std::memcpy(&paths.entries[3], &sample, sizeof sample);
  paths.paths = {{0, 1, 0}, {1, 3, 1}};
  const std::vector<float> sums = evaluate(scene, {}, paths, GetParam(), 0.5);
  const std::size_t stride = sums.size() / 2;
  for (std::size_t k = 0; k < 200; ++k) EXPECT_EQ(sums[stride + k] != 0, k == 70) << sums[stride + k];
}

INSTANTIATE_TEST_SUITE_P(, Invariants, testing::ValuesIn(available_isas()), isa_name);

TEST(EvaluatorErrors, BrokenPathsAreOurBugs) {
  std::mt19937 random(9);
  const FlatScene scene = make_scene(make_channels(8, Layout::kRegular, random), random);
  const auto run = [&](const KbPathVertex& vertex, uint32_t count, uint32_t pixel) {
    PathBuffer paths;
    paths.entries = {vertex};
    paths.paths = {{0, count, pixel}};
    Evaluator evaluator(scene, {}, Isa::kAuto);
    std::vector<float> sums(evaluator.stride(), 0.0f);
    evaluator.add_shared(paths, 0.5, FollowingRows(evaluator, sums));
  };
  KbPathVertex vertex{};
  vertex.head = KB_KIND_SCALED | KB_VERTEX_SCATTER;
  EXPECT_NO_THROW(run(vertex, 1, 0));
  EXPECT_NO_THROW(run(vertex, 0, 0));
  EXPECT_THROW(run(vertex, 2, 0), std::logic_error);
  EXPECT_THROW(run(vertex, 1, 1), std::logic_error);
  vertex.row_a = 5000;
  EXPECT_THROW(run(vertex, 1, 0), std::logic_error);
  vertex.head |= KB_VERTEX_TEX_A;  // without its sample
  EXPECT_THROW(run(vertex, 1, 0), std::logic_error);
  vertex.head = KB_KIND_CONDUCTOR | KB_VERTEX_SCATTER | 500u << KB_VERTEX_MATERIAL_SHIFT;
  EXPECT_THROW(run(vertex, 1, 0), std::logic_error);
  Evaluator evaluator(scene, {}, Isa::kAuto);
  std::vector<float> sums(evaluator.stride());
  PathBuffer paths;
  paths.paths.resize(1);
  EXPECT_THROW(evaluator.add_per_path(paths, {}, FollowingRows(evaluator, sums)), std::logic_error);
}

TEST(InstructionSets, NamesAndResolution) {
  EXPECT_STREQ(to_string(Isa::kAuto), "auto");
  EXPECT_STREQ(to_string(Isa::kSse4), "sse4");
  EXPECT_STREQ(to_string(Isa::kAvx2), "avx2");
  EXPECT_STREQ(to_string(Isa::kAvx512), "avx512");
  EXPECT_EQ(resolve_isa(Isa::kAuto), available_isas().back());
  for (Isa isa : {Isa::kSse4, Isa::kAvx2, Isa::kAvx512}) {
    if (is_available(isa)) {
      EXPECT_EQ(resolve_isa(isa), isa);
    } else {
      EXPECT_THROW(resolve_isa(isa), DeviceError);
    }
  }
}

}  // namespace
}  // namespace kiloband::test::test_invariants
