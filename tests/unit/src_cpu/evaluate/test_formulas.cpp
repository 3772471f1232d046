// Small paths whose values follow by hand: the reading of the records that fast code and oracle share.
#include <cmath>
#include <cstring>

#include "random_scene.hpp"
#include "spectral/planck.hpp"
#include "validation/oracle/evaluate_reference.hpp"

namespace kiloband::test::test_formulas {
namespace {

/// Constant spectra; row 0: 1/2, row 1: 1/4, row 2: emission of 3 per nm.
FlatScene constant_scene(const ChannelList& channels) {
  FlatScene scene;
  scene.channels = channels;
  scene.channel_scale.assign(channels.size(), 4.0);
  for (double value : {0.5, 0.25, 3.0})
    scene.spectra.push_back(row(table(300, 1000, {value, value}), value > 1));
  return scene;
}

PathBuffer one_path(const std::vector<KbPathVertex>& vertices) {
  PathBuffer paths;
  paths.entries = vertices;
  paths.paths = {{0, static_cast<uint32_t>(vertices.size()), 0}};
  return paths;
}

KbPathVertex vertex_of(uint32_t head) {
  KbPathVertex v{};
  v.head = head;
  v.row_a = 0;
  v.row_b = 1;
  v.emit_row = v.nee_row = 2;
  return v;
}

/// The value in W m^-2 sr^-1 of channel k from the fast code; the oracle must agree.
double channel(const FlatScene& scene, const PathBuffer& paths, Isa isa, std::size_t k, double mu = 0.5) {
  const double value = evaluate(scene, {}, paths, isa, mu)[k] * scene.channel_scale[k];
  EXPECT_NEAR(evaluate_path_reference(scene, {}, paths, 0, mu)[k], value, 1e-6 * std::abs(value));
  return value;
}

class Formulas : public EachIsa {};

TEST_P(Formulas, VerticesByHand) {
  const FlatScene scene = constant_scene({{500, 510, {}}, {600, 620, {}}});
  KbPathVertex first = vertex_of(KB_KIND_SCALED | KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  first.emit_weight = 0.5f;
  first.nee0 = 0.2f;
  first.scatter0 = 0.8f;
  KbPathVertex second = vertex_of(KB_KIND_TWO_TERM | KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  second.nee0 = 1;
  second.nee1 = 2;
  second.scatter0 = 0.5f;
  second.scatter1 = 1;
  KbPathVertex third = vertex_of(KB_KIND_SCALED | KB_VERTEX_EMIT);
  third.emit_weight = 1;
  // 3 (0.5 + 0.5 0.2), tau 0.4; + 3 * 0.4 (0.5 + 2 0.25), tau 0.4 (0.25 + 0.25) = 0.2; + 3 * 0.2
  const double expected = 1.8 + 1.2 + 0.6;
  const PathBuffer paths = one_path({first, second, third});
  EXPECT_NEAR(channel(scene, paths, GetParam(), 0), 10 * expected, 1e-5);
  EXPECT_NEAR(channel(scene, paths, GetParam(), 1), 20 * expected, 2e-5);
}

/// The sign of the reconstruction filter, in front of a plain vertex and of others.
TEST_P(Formulas, NegativePaths) {
  const FlatScene scene = constant_scene({{500, 510, {}}});
  for (const uint32_t kind : {KB_KIND_SCALED, KB_KIND_TWO_TERM}) {
    KbPathVertex first = vertex_of(kind | KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER);
    first.emit_weight = 0.5f;
    first.nee0 = first.scatter0 = 0.5f;
    KbPathVertex second = vertex_of(KB_KIND_SCALED | KB_VERTEX_EMIT);
    second.emit_weight = 1;
    const double positive = channel(scene, one_path({first, second}), GetParam(), 0);
    EXPECT_GT(positive, 0);
    first.head |= KB_VERTEX_NEGATIVE;
    EXPECT_EQ(channel(scene, one_path({first, second}), GetParam(), 0), -positive);
  }
}

/// Light of two emission rows by turns, from light samples and from emitters that paths hit, and weights that would
/// leave the range of floats if they were multiplied apart from the reflectances.
TEST_P(Formulas, LightsByTurnsAndFarWeights) {
  FlatScene scene = constant_scene({{400, 410, {}}});
  scene.spectra.push_back(row(table(300, 1000, {5.0, 5.0}), true));  // row 3
  scene.spectra.push_back(row(table(300, 1000, {1e-9, 1e-9})));      // row 4
  KbPathVertex v = vertex_of(KB_KIND_SCALED | KB_VERTEX_EMIT | KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  v.emit_weight = 0.5f;
  v.nee0 = 0.25f;
  v.scatter0 = 2;
  const auto lit_by = [&](uint16_t emit, uint16_t nee) {
    v.emit_row = emit;
    v.nee_row = nee;
    return v;
  };
  // tau is 1 throughout: E/2 + I/8 each, 10 nm wide.
  const PathBuffer turns = one_path({lit_by(2, 2), lit_by(2, 3), lit_by(3, 3), lit_by(2, 3), lit_by(2, 2)});
  EXPECT_NEAR(channel(scene, turns, GetParam(), 0), 10 * ((4 * 3 + 5) / 2.0 + (2 * 3 + 3 * 5) / 8.0),
              1e-5 * 90);
  KbPathVertex dark = v;
  dark.head &= ~(KB_VERTEX_EMIT | KB_VERTEX_NEE);
  dark.row_a = 4;
  dark.scatter0 = 1e9f;
  std::vector<KbPathVertex> far(12, dark);
  far.push_back(lit_by(3, 2));
  EXPECT_NEAR(channel(scene, one_path(far), GetParam(), 0), 10 * (5 / 2.0 + 3 / 8.0), 1e-5 * 30);
}

TEST_P(Formulas, NonlinearAndDegraded) {
  FlatScene scene = constant_scene({{500, 501, {}}, {600, 601, {}}, {700, 701, {}}});
  KbMaterial plastic{};
  plastic.escape = 0.5f;
  scene.materials = {plastic};
  KbPathVertex first = vertex_of(KB_KIND_NONLINEAR | KB_VERTEX_NEE | KB_VERTEX_SCATTER);
  first.nee1 = 1;
  first.scatter0 = 1;
  KbPathVertex second = vertex_of(KB_KIND_SCALED | KB_VERTEX_SCATTER | KB_VERTEX_DEGRADE);
  second.scatter0 = 3;
  second.scatter1 = kb_channel_weight(1);
  KbPathVertex third = vertex_of(KB_KIND_SCALED | KB_VERTEX_EMIT);
  third.emit_weight = 1;
  const PathBuffer paths = one_path({first, second, third});
  const double before = 3 * 0.25 / (1 - 0.25 * 0.5);  // then tau = 0.5, and 0.5 * 0.5 * 3 in channel 1 alone
  EXPECT_NEAR(channel(scene, paths, GetParam(), 0), before, 1e-5);
  EXPECT_NEAR(channel(scene, paths, GetParam(), 1), before + 0.75 * 3, 1e-5);
  EXPECT_NEAR(channel(scene, paths, GetParam(), 2), before, 1e-5);
}

TEST_P(Formulas, TexelsAndWrapping) {
  // 2 x 1 flat texels 0.2 and 0.6: the neighbour of the second is the first
  // (repeat) or itself (mirror, clamp).
  FlatScene scene = constant_scene({{500, 501, {}}});
  scene.texels = {{0, 0, 1e10f, 0.2f}, {0, 0, 1e10f, 0.6f}};
  for (uint32_t wrap : {KB_WRAP_REPEAT, KB_WRAP_MIRROR, KB_WRAP_CLAMP})
    scene.textures.push_back({2, 1, 0, wrap, 0, KB_NONE, {}});
  scene.textures.push_back({2, 1, 0, KB_WRAP_CLAMP, KB_TEXTURE_ENVMAP, KB_NONE, {}});
  const double expected[] = {0.3, 0.6, 0.6, 0.3};
  for (uint32_t t = 0; t < 4; ++t) {
    KbPathVertex v = vertex_of(KB_KIND_SCALED | KB_VERTEX_NEE | KB_VERTEX_TEX_A);
    v.nee0 = 1;
    PathBuffer paths = one_path({v, {}});
    const KbTextureSample sample{t, 1, 0.75f, 0.5f};
    std::memcpy(&paths.entries[1], &sample, sizeof sample);
    EXPECT_NEAR(channel(scene, paths, GetParam(), 0), 3 * expected[t], 1e-6) << t;
    // The same texture as emission without an illuminant: the integral over 1 nm.
    v.head = KB_KIND_SCALED | KB_VERTEX_EMIT | KB_VERTEX_TEX_EMIT;
    v.emit_weight = 1;
    paths.entries[0] = v;
    EXPECT_NEAR(channel(scene, paths, GetParam(), 0), expected[t], 1e-6) << t;
  }
}

TEST_P(Formulas, SigmoidsKeepRelativePrecision) {
  // c2 = -1000: S = 1 / (4 v^2) = 2.5e-7 (1 - 3/(4 v^2));
  // 1/2 + v / (2 sqrt(1 + v^2)) in float would be 0 or 6e-8.
  FlatScene scene = constant_scene({{500, 501, {}}});
  scene.texels = {{1e-12f, 0, -1000, 1}};
  scene.textures = {{1, 1, 0, KB_WRAP_CLAMP, 0, KB_NONE, {}}};
  KbPathVertex v = vertex_of(KB_KIND_SCALED | KB_VERTEX_NEE | KB_VERTEX_TEX_A);
  v.nee0 = 1;
  PathBuffer paths = one_path({v, {}});
  std::memset(&paths.entries[1], 0, sizeof paths.entries[1]);
  const double value = evaluate(scene, {}, paths, GetParam(), 0.5)[0] * 4.0;
  EXPECT_NEAR(value, 3 * 2.5e-7, 3 * 2.5e-7 * 2e-6);
}

TEST_P(Formulas, DerivedChannelsByHand) {
  // Channel 0 lies inside channel 1, channel 2 apart: at the middle, 505 nm and 550 nm;
  // 700 is outside the response.
  FlatScene scene = constant_scene({{500, 510, {}}, {500, 600, {}}, {690, 710, {}}});
  scene.channel_scale = {2, 16, 64};
  DerivedChannels derived;
  derived.names = {"flat", "ramp"};
  derived.responses = {table(400, 200, {1, 1}), table(500, 100, {0, 1})};
  KbPathVertex v = vertex_of(KB_KIND_SCALED | KB_VERTEX_EMIT);
  v.emit_weight = 1;
  const PathBuffer paths = one_path({v});
  Evaluator evaluator(scene, derived, GetParam());
  EXPECT_EQ(evaluator.derived_scale(0), 16);
  std::vector<float> sums(evaluator.stride(), 0.0f);
  evaluator.add_shared(paths, 0.5, FollowingRows(evaluator, sums));
  // At 505 nm two channels overlap, of 10 and 100 nm, at 550 nm channel 1 is alone.
  constexpr double kShare = (1 / 10.0) / (1 / 10.0 + 1 / 100.0);
  EXPECT_NEAR(sums[evaluator.derived_offset()] * 16.0, kShare * 30 + 300, 1e-4);
  EXPECT_NEAR(sums[evaluator.derived_offset() + 1] * 16.0, 0.05 * kShare * 30 + 0.5 * 300, 1e-4);
  const std::vector<double> expected = evaluate_path_reference(scene, derived, paths, 0, 0.5);
  EXPECT_NEAR(expected[3], kShare * 30 + 300, 1e-9);
  EXPECT_NEAR(expected[4], 0.05 * kShare * 30 + 0.5 * 300, 1e-9);
}

TEST_P(Formulas, FaintEmissionDoesNotUnderflow) {
  // 200 K at 0.3 um: about 1e-96; and a bright channel beside it.
  FlatScene scene;
  scene.channels = {{299.5, 300.5, {}}, {10000, 10100, {}}};
  SpectrumRow thermal;
  thermal.is_planck = thermal.is_emission = true;
  thermal.temperature_k = 200;
  scene.spectra = {thermal, row(table(100, 1e6, {0.5, 0.5}))};
  for (const Channel& c : scene.channels)
    scene.channel_scale.push_back(
        std::exp2(std::floor(std::log2(planck_radiance(c.centre_nm(), 200) * c.width_nm()))));
  DerivedChannels derived;
  derived.names = {"uv"};
  derived.responses = {table(290, 20, {1, 1})};
  KbPathVertex v{};
  v.head = KB_KIND_SCALED | KB_VERTEX_NEE;
  v.row_a = 1;
  v.nee0 = 1;
  const PathBuffer paths = one_path({v});
  for (bool shared : {true, false}) {
    Evaluator evaluator(scene, derived, GetParam());
    const std::vector<float> sums = evaluate(scene, derived, paths, GetParam(), 0.25, shared);
    const double faint = 0.5 * planck_radiance(299.75, 200);
    ASSERT_GT(faint, 0);
    ASSERT_LT(faint, 1e-90);
    EXPECT_NEAR(sums[0] * scene.channel_scale[0] / faint, 1, 1e-6);
    EXPECT_NEAR(sums[1] * scene.channel_scale[1] / (50 * planck_radiance(10025, 200)), 1, 1e-6);
    EXPECT_EQ(evaluator.derived_scale(0), scene.channel_scale[0]);
    EXPECT_NEAR(sums[evaluator.derived_offset()] * evaluator.derived_scale(0) / faint, 1, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(, Formulas, testing::ValuesIn(available_isas()), isa_name);

}  // namespace
}  // namespace kiloband::test::test_formulas
