// CPU devices take slots through whole bounces in one launch; with the stages one by one, as GPUs have them and as `kiloband trace` wants them, paths
// are the same: their values in all channels bit by bit (an entry with one texture sample has a half that nobody writes or reads).
#include <gtest/gtest.h>

#include "backend_images.hpp"
#include "path_comparison.hpp"
#include "src_gpu/group_renderer.hpp"

namespace kiloband::test::stages_test {
namespace {

using namespace opencl;

class Stages : public testing::TestWithParam<std::string> {
 protected:
  std::vector<TracedPath> trace(bool hits) { return groups_.trace(pixels_, {1, 2, 1}, hits); }

  std::vector<ImagePixel> pixels() const {
    std::vector<ImagePixel> all;
    const PixelRect rect = film_rect(host_.scene);
    for (uint32_t i = 0; i < rect.pixels(); ++i)
      all.push_back({rect.x0 + i % rect.width, rect.y0 + i / rect.width});
    return all;
  }

  ZooFolder folder_;
  HostScene host_{std::make_shared<FlatScene>(folder_.flatten(zoo_scene(GetParam()))), {}};
  DeviceContext context_{select_device(std::nullopt), {}};
  DeviceState state_{context_, host_, {.method = Method::kDpeptPath, .specialised = false}};
  const std::vector<ImagePixel> pixels_ = pixels();
  GroupRenderer groups_{state_, {WavelengthMode::kPerPath, SamplerType::kSobol, 77, 4}, 0.5, {}, {}};
};

TEST_P(Stages, TogetherAndApartGiveTheSamePaths) {
  const auto apart = trace(true), together = trace(false);
  ASSERT_EQ(apart.size(), 1024u);
  ASSERT_EQ(together.size(), apart.size());
  std::size_t entries = 0;
  for (std::size_t p = 0; p < apart.size(); ++p) {
    EXPECT_FALSE(apart[p].hits.empty());
    EXPECT_TRUE(together[p].hits.empty());
    EXPECT_EQ(together[p].invalid, apart[p].invalid);
    ASSERT_EQ(together[p].entries.size(), apart[p].entries.size()) << p;
    EXPECT_EQ(path_values(host_.scene, together[p], 0.3), path_values(host_.scene, apart[p], 0.3)) << p;
    entries += apart[p].entries.size();
  }
  EXPECT_GT(entries, apart.size() / 4);
}

INSTANTIATE_TEST_SUITE_P(Zoo, Stages, testing::ValuesIn(zoo_names()), [](const auto& p) { return p.param; });

}  // namespace
}  // namespace kiloband::test::stages_test
