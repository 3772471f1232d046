// Long paths and many samples: an albedo of 1 - 1e-6 and other series of 1000 terms, mirrors,
// a million samples.
#include <cmath>

#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

const std::string kView = perspective(lookat("0.3, -0.2, 0.4", "-0.5, 0.1, -0.9"), 60, film(8), 1e-3);

std::string box(const std::string& content) {
  return shape("cube", kInwards + content);
}

/// (1 - rho^n) / (1 - rho), accurate for rho next to 1.
double partial_sum(double rho, int n) {
  return -std::expm1(n * std::log1p(rho - 1)) / (1 - rho);
}

/// A closed box, reflectance rho = 1 - 1e-6, cut after 1000 vertices:
/// L = Le (1 + rho + ... + rho^999), 999.5 Le.
///   ambient temperature: Le = (1 - rho) B, no variance. rho in float is off by up to 3e-8, rho^i by i times
///     that: 1.5e-5 of the sum, and as much again for the rounding of the running product.
///   area lights: Le by light and BSDF samples, roulette from the fifth vertex on: a t-test.
/// The reflectance once flat, and once falling from 1 - 1e-6 to 1 - 3e-6 over the channel and back,
/// so that it is a table.
std::vector<HardFigure> albedo_next_to_one(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(1, 8, 64))};
  const double rho = 1 - 1e-6, sum = partial_sum(rho, 1000), planck = planck_per_nm(10000.0005, 300);
  const std::string flat =
      scene_text::scene(1000, kView + box(diffuse(rho)) + thermal(300), integer("rr_depth", kNoRoulette));
  const TrialImage image = trial.render(flat, settings);
  trial.exact("isothermal box, 1000 vertices", image, 0, 1e-6 * sum * planck, 3e-5, "1000 roundings of rho");
  trial.oracle("its evaluation", flat, settings);
  const std::string sloped =
      bsdf("diffuse", spectrum("reflectance", "9000:0.999999, 10000:0.999998, 11000:0.999999"));
  const TrialSettings wide{.bands = "9500-9500.001, 10000-10000.001", .samples = settings.samples};
  const TrialImage table = trial.render(
      scene_text::scene(1000, kView + box(sloped) + thermal(300), integer("rr_depth", kNoRoulette)), wide);
  trial.exact("reflectance as a table, 1 - 1.5e-6", table, 0,
              1.5e-6 * partial_sum(1 - 1.5e-6, 1000) * planck_per_nm(9500.0005, 300), 3e-5,
              "1000 roundings of rho");
  trial.exact("reflectance as a table, 1 - 2e-6", table, 1, 2e-6 * partial_sum(1 - 2e-6, 1000) * planck, 3e-5,
              "1000 roundings of rho");
  const TrialSettings random{.samples = static_cast<uint32_t>(trial.by_effort(1, 8, 64)),
                             .replicates = static_cast<uint32_t>(trial.by_effort(12, 32, 32))};
  const TrialImage lamps = trial.render(scene_text::scene(1000, kView + box(diffuse(rho) + lamp(2))), random);
  trial.statistical("emitting box, 1000 vertices, roulette", lamps, 0, 2 * sum, 3e-5);
  return trial.finish();
}

/// 1000 vertices where the throughput falls by e: rho = 0.999, by the ambient furnace
/// and between two parallel mirrors,
///   L = rho^1000 L0:
/// the ray leaves after 1000 reflections towards an environment of L0 = 1. The float of 0.999 is off by up to
/// 3e-8 relative, its power by 3e-5, and 1000 products by a random walk of 2e-6.
std::vector<HardFigure> thousand_vertices(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.samples = static_cast<uint32_t>(trial.by_effort(1, 8, 64))};
  const TrialImage image = trial.render(
      scene_text::scene(1000, kView + box(diffuse(0.999)) + thermal(300), integer("rr_depth", kNoRoulette)),
      settings);
  trial.exact("isothermal box", image, 0, 1e-3 * partial_sum(0.999, 1000) * planck_per_nm(10000.0005, 300),
              3.5e-5, "1000 roundings of rho");
  const std::string mirror = bsdf("twosided", bsdf("conductor", spectrum("specular_reflectance", 0.999)));
  const std::string wall = scale(2000, 10, 1) + rotate(0, 1, 0, 90);
  const std::string mirrors = shape("rectangle", to_world(wall + translate(1, 0, 0)) + mirror) +
                              shape("rectangle", to_world(wall + translate(-1, 0, 0)) + mirror);
  const std::string view = orthographic(lookat("0, 0, 0", "1, 0, 1"), 0.1, film(8), 1e-3);
  const std::string scene = scene_text::scene(-1, view + mirrors + sky(1), integer("rr_depth", kNoRoulette));
  trial.exact("two mirrors, 1000 reflections", trial.render(scene, settings), 0, std::pow(0.999, 1000),
              3.5e-5, "1000 roundings of rho");
  trial.oracle("evaluation between mirrors", scene, settings);
  return trial.finish();
}

/// A million samples (quick: 10^5) of one pixel in ONE replicate. Each is 0.1, which float does not hold: a
/// sum in float that stalls, or that rounds a million times, is off by 1e-3 and more; the mean must be 0.1 to
/// its own rounding. And a furnace whose samples vary, by a t-test whose standard error is a few 1e-5. The
/// method pt follows one path of a pixel at a time: it gets a tenth of the samples.
std::vector<HardFigure> million_samples(const HardCaseContext& context) {
  Trial trial(context);
  const uint32_t share = context.backend == "opencl:pt" ? 10 : 1;
  const auto count = static_cast<uint32_t>(trial.by_effort(100000, 1000000, 20000000)) / share;
  const std::string pixel = perspective(lookat("0, 0, 0", "0, 0, 1"), 60, film(1), 1e-3);
  const TrialImage same =
      trial.render(scene_text::scene(1, pixel + sky(0.1)), {.samples = count, .replicates = 1});
  trial.exact(short_text(count) + " equal samples in one replicate", same, 0, 0.1, 4e-6,
              "at most 64 samples are summed in float: 64 * 2^-24");
  const std::string inside = perspective(lookat("0.3, -0.2, 0.4", "-0.5, 0.1, -0.9"), 60, film(1), 1e-3);
  const TrialImage box_image = trial.render(scene_text::scene(8, inside + box(diffuse(0.5) + lamp(2))),
                                            {.samples = count / 40 + 1, .replicates = 40});
  trial.statistical(short_text(count) + " samples of an emitting box", box_image, 0, 2 * partial_sum(0.5, 8),
                    1e-6);
  return trial.finish();
}

}  // namespace

std::vector<HardCase> length_cases() {
  return {{"albedo_1-1e-6", "a closed box of albedo 1 - 1e-6 at depth 1000", albedo_next_to_one},
          {"depth_1000", "paths of 1000 vertices that lose a part at each", thousand_vertices},
          {"samples_1e6", "a million samples in a pixel", million_samples}};
}

}  // namespace kiloband::validation
