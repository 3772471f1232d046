// What the fingerprint of a render sees.
#include "render/checkpoint/fingerprint.hpp"

#include "spectral/channel_knots.hpp"
#include "tests/unit/render/session_fixture.hpp"

namespace kiloband::fingerprint_test {
namespace {

TEST_F(SessionTest, FingerprintSeesSceneSamplingAndInstructionSet) {
  const SamplingSettings sampling;
  SamplingSettings other = sampling;
  other.seed = 1;
  FlatScene moved = scene_;
  moved.shapes[0].to_world[3] += 1e-6f;
  const uint64_t base = render_fingerprint(scene_, sampling, "avx2", {});
  EXPECT_EQ(base, render_fingerprint(scene_, sampling, "avx2", {}));
  EXPECT_NE(base, render_fingerprint(scene_, other, "avx2", {}));
  EXPECT_NE(base, render_fingerprint(moved, sampling, "avx2", {}));
  FlatScene in_gas = scene_, in_other_gas = scene_, full_of_gas = scene_;
  in_gas.media.resize(1);
  in_other_gas.media.resize(1);
  in_other_gas.media[0].scale = 2;
  full_of_gas.atmosphere = 0;
  EXPECT_NE(base, render_fingerprint(in_gas, sampling, "avx2", {}));
  EXPECT_NE(base, render_fingerprint(full_of_gas, sampling, "avx2", {}));
  EXPECT_NE(render_fingerprint(in_gas, sampling, "avx2", {}),
            render_fingerprint(in_other_gas, sampling, "avx2", {}));
  FlatScene absorbing = scene_;
  absorbing.spectra[0].absorption =
      std::make_shared<const ChannelKnots>(ChannelKnots{{0, 2}, {0, 1}, {1, 1}});
  EXPECT_NE(base, render_fingerprint(absorbing, sampling, "avx2", {}));
  FlatScene textured = scene_;
  textured.band_sets.push_back({{500}, 490, 510});
  textured.spectral_texels.push_back(std::make_shared<const std::vector<float>>(3, 0.5f));
  FlatScene brighter = textured;
  brighter.spectral_texels[0] = std::make_shared<const std::vector<float>>(3, 0.6f);
  const uint64_t dim = render_fingerprint(textured, sampling, "avx2", {});
  EXPECT_NE(base, dim);
  EXPECT_NE(dim, render_fingerprint(brighter, sampling, "avx2", {}));
  textured.band_sets[0].scale = 2;
  EXPECT_NE(dim, render_fingerprint(textured, sampling, "avx2", {}));
  EXPECT_NE(base, render_fingerprint(scene_, sampling, "sse4", {}));
  const DerivedChannels one{{"x"}, {RegularTable{400, 1, {1, 1}}}},
      other_values{{"x"}, {RegularTable{400, 1, {1, 2}}}};
  EXPECT_NE(base, render_fingerprint(scene_, sampling, "avx2", one));
  EXPECT_NE(render_fingerprint(scene_, sampling, "avx2", one),
            render_fingerprint(scene_, sampling, "avx2", other_values));
}

}  // namespace
}  // namespace kiloband::fingerprint_test
