// Replicates that are gathered on the device (Backend::render_replicates) make the film that one after the other makes.
#include <gtest/gtest.h>

#include <bit>

#include "backend_images.hpp"
#include "src_gpu/film_delivery.hpp"

namespace kiloband::test::replicates_test {
namespace {

/// Everything that can be read of a film.
struct Contents {
  std::vector<uint32_t> mean, variance;  // bits
  std::vector<uint64_t> samples, counts;
  std::vector<std::vector<double>> sums;
};

std::vector<uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<uint32_t> bits;
  for (const float v : values) bits.push_back(std::bit_cast<uint32_t>(v));
  return bits;
}

Contents contents_of(const SpectralFilm& film) {
  Contents all;
  const PixelRect& rect = film.rect();
  std::vector<float> mean(rect.width * film.options().channels);
  std::vector<float> variance(film.options().variance ? mean.size() : 0);
  for (uint32_t y = 0; y < rect.height; ++y) {
    film.row(y, mean, variance);
    const auto add = [](std::vector<uint32_t>& to, const std::vector<uint32_t>& bits) {
      to.insert(to.end(), bits.begin(), bits.end());
    };
    add(all.mean, bits_of(mean));
    add(all.variance, bits_of(variance));
    for (uint32_t x = 0; x < rect.width; ++x) all.samples.push_back(film.samples(x, y));
  }
  film.add_image_sums(all.sums, all.counts);
  return all;
}

/// Sums over the image are added in another order, of pairs of floats: within 2^-40.
void expect_same(const Contents& a, const Contents& b) {
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.variance, b.variance);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.counts, b.counts);
  ASSERT_EQ(a.sums.size(), b.sums.size());
  for (std::size_t r = 0; r < a.sums.size(); ++r)
    for (std::size_t c = 0; c < a.sums[r].size(); ++c)
      EXPECT_NEAR(a.sums[r][c], b.sums[r][c], 1e-12 * std::abs(b.sums[r][c])) << r << ", " << c;
}

/// The film of a render: with sums where replicates may come in parts.
SpectralFilm make_film(const Backend& backend, const PixelRect& rect, const ReplicatePlan& plan,
                       bool variance, bool sums) {
  FilmOptions options{backend.film_scale().size(), plan.replicates, variance};
  if (sums) options.sums = backend.sum_rule();
  options.most_samples = static_cast<uint32_t>(plan.size(0));
  return {rect, options};
}

void render_one_by_one(Backend& backend, SpectralFilm& film, const ReplicatePlan& plan) {
  const std::vector<uint32_t> blocks = film.all_blocks();
  const std::atomic<bool> stop{false};
  for (uint32_t r = 0; r < plan.replicates; ++r)
    backend.render(film, {r, 0, static_cast<uint32_t>(plan.size(r))}, blocks, stop, {});
  film.finish_replicates();
}

struct GatheredReplicates : testing::Test {
  ZooFolder folder;
  const std::atomic<bool> go_on{false};

  std::unique_ptr<Backend> backend(const std::string& name, const FlatScene& scene, uint32_t replicates,
                                   const DerivedChannels& derived = {},
                                   opencl::Options options = {.specialised = false}) {
    return make_zoo_backend(name, scene, derived,
                            {WavelengthMode::kShared, SamplerType::kSobol, 3, replicates}, options);
  }

  void expect_same_films(Backend& renderer, const PixelRect& rect, const ReplicatePlan& plan) {
    for (const bool variance : {true, false}) {
      for (const bool sums : {true, false}) {
        SCOPED_TRACE(testing::Message() << (variance ? "variances" : "means") << (sums ? ", sums" : ""));
        SpectralFilm expected = make_film(renderer, rect, plan, variance, sums);
        SpectralFilm film = make_film(renderer, rect, plan, variance, sums);
        render_one_by_one(renderer, expected, plan);
        uint64_t told = 0;
        EXPECT_EQ(renderer.render_replicates(film, plan, go_on, [&](uint64_t n) { told += n; }),
                  plan.replicates);
        EXPECT_EQ(told, plan.samples * rect.pixels());
        film.finish_replicates();
        expect_same(contents_of(film), contents_of(expected));
        EXPECT_TRUE(sums || film.has(plan.replicates - 1, 0));
      }
    }
  }
};

/// Blocks of several parts, clipped ones, replicates of unequal size, samples of several chunks, derived channels.
TEST_F(GatheredReplicates, MakeTheFilmOfOneByOne) {
  const FlatScene scene = folder.flatten(scene_zoo().front());
  for (const std::string& name : kOpenclMethods) {
    SCOPED_TRACE(name);
    const auto plain = backend(name, scene, 3);
    expect_same_films(*plain, {28, 3, 40, 38}, {7, 3});
    const auto derived = backend(name, scene, 2, zoo_responses(scene.channels));
    expect_same_films(*derived, {28, 3, 6, 3}, {69, 2});
  }
}

TEST_F(GatheredReplicates, WithSamplesThatAreNotFinite) {
  const FlatScene scene = scene_beyond_floats(40, 9);
  const auto renderer = backend("opencl:dpept-batch", scene, 4);
  expect_same_films(*renderer, film_rect(scene), {8, 4});
  EXPECT_GT(renderer->statistics().invalid_samples, 16u);
}

/// An interrupted render has what it had by then, evenly: here a replicate and a part of the next.
TEST_F(GatheredReplicates, StopEvenly) {
  const FlatScene scene = folder.flatten(scene_zoo().front());
  const PixelRect rect{28, 3, 40, 38};  // rounds of fewer pixels may be one
  const ReplicatePlan plan{96, 3};
  for (const std::string& name : kOpenclMethods) {
    for (const bool sums : {true, false}) {
      SCOPED_TRACE(testing::Message() << name << (sums ? ", sums" : ""));
      const auto renderer = backend(name, scene, 3);
      SpectralFilm film = make_film(*renderer, rect, plan, true, sums);
      std::atomic<bool> stop{false};
      uint64_t told = 0;
      const auto on_samples = [&](uint64_t samples) {
        told += samples;
        if (told > 34 * rect.pixels()) stop = true;
      };
      EXPECT_EQ(renderer->render_replicates(film, plan, stop, on_samples), 2u);
      const Contents stopped = contents_of(film);
      const uint64_t samples = stopped.samples.front();
      EXPECT_GT(samples, 34u);
      EXPECT_LT(samples, 64u);
      EXPECT_EQ(told, samples * rect.pixels());
      SpectralFilm expected = make_film(*renderer, rect, plan, true, sums);
      const std::vector<uint32_t> blocks = expected.all_blocks();
      renderer->render(expected, {0, 0, 32}, blocks, go_on, {});
      renderer->render(expected, {1, 0, static_cast<uint32_t>(samples - 32)}, blocks, go_on, {});
      expected.finish_replicates();
      expect_same(stopped, contents_of(expected));
    }
  }
}

/// Where moments of all pixels do not fit, nothing is done; what follows has the memory that it would have had.
TEST_F(GatheredReplicates, NeedMemory) {
  const FlatScene scene = folder.flatten(zoo_scene("crop_window"), "450:650:100");
  const PixelRect rect = film_rect(scene);
  const ReplicatePlan plan{6, 2};
  opencl::Options options;
  options.specialised = false;
  options.device_memory = uint64_t{600} << 10;
  const auto small = backend("opencl:dpept-batch", scene, 2, {}, options),
             large = backend("opencl:dpept-batch", scene, 2);
  SpectralFilm film = make_film(*small, rect, plan, true, true),
               expected = make_film(*large, rect, plan, true, true);
  EXPECT_EQ(small->render_replicates(film, plan, go_on, {}), 0u);
  render_one_by_one(*small, film, plan);
  EXPECT_EQ(large->render_replicates(expected, plan, go_on, {}), 2u);
  expect_same(contents_of(expected), contents_of(film));
}

/// What a film was given may be taken back, should the device fail while it hands the rest over.
TEST_F(GatheredReplicates, MayBeForgotten) {
  const FlatScene scene = folder.flatten(scene_zoo().front());
  const auto renderer = backend("opencl:dpept-batch", scene, 2);
  const PixelRect rect{28, 3, 6, 3};
  const ReplicatePlan plan{4, 2};
  for (const bool sums : {true, false}) {
    SpectralFilm film = make_film(*renderer, rect, plan, true, sums);
    SpectralFilm expected = make_film(*renderer, rect, plan, true, sums);
    EXPECT_EQ(renderer->render_replicates(film, plan, go_on, {}), 2u);
    opencl::forget_replicates(film);
    EXPECT_EQ(film.samples(0, 0), 0u);
    render_one_by_one(*renderer, film, plan);
    render_one_by_one(*renderer, expected, plan);
    expect_same(contents_of(film), contents_of(expected));
  }
}

/// The CPU's films are gathered where they are.
TEST_F(GatheredReplicates, AreNoneOfTheCpu) {
  const FlatScene scene = folder.flatten(scene_zoo().front());
  const auto renderer = backend("cpu", scene, 2);
  SpectralFilm film = make_film(*renderer, {28, 3, 4, 3}, {4, 2}, true, false);
  EXPECT_EQ(renderer->render_replicates(film, {4, 2}, go_on, {}), 0u);
  EXPECT_EQ(film.samples(0, 0), 0u);
}

}  // namespace
}  // namespace kiloband::test::replicates_test
