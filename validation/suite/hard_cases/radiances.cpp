// Radiances from 1e-20 to 1e15 W m^-2 sr^-1 nm^-1, and an environment of which one pixel is
// a million times brighter.
#include <bit>
#include <cmath>

#include "base/temporary_folder.hpp"
#include "validation/suite/hard_cases/groups.hpp"
#include "validation/suite/hard_cases/trial.hpp"
#include "validation/suite/scene_text.hpp"

namespace kiloband::validation {
namespace {

using namespace scene_text;

constexpr double kDecades[] = {1e-20, 1e-10, 1, 1e10, 1e15};
const char* const kBands = "400-410, 500-510, 600-610, 700-710, 800-810";

/// Flat within each channel of kBands, with kDecades as values.
std::string decades(const std::string& name) {
  std::string text;
  for (int i = 0; i < 5; ++i) {
    const std::string value = ":" + exact(kDecades[i]);
    text += (i ? ", " : "") + std::to_string(400 + 100 * i - 5) + value + ", " +
            std::to_string(400 + 100 * i + 15) + value;
  }
  return spectrum(name, text);
}

/// Five channels of one light over 35 decades: seen directly L, and from a point light of intensity I at 1 m
/// over a diffuse square rho I / pi. And both ends in ONE channel: two lamps side by side, 1e15 and 1e-20; a
/// film in float, in units of the brightest, holds the darker as 1e-35, still a normal number.
std::vector<HardFigure> range_of_radiance(const HardCaseContext& context) {
  Trial trial(context);
  const TrialSettings settings{.bands = kBands,
                               .samples = static_cast<uint32_t>(trial.by_effort(4, 64, 1024))};
  const std::string view = orthographic(lookat("0, 0, 2", "0, 0, 0"), 1e-5, film(4), 1e-3);
  const std::string point =
      emitter("point", decades("intensity") + "<point name=\"position\" value=\"0, 0, 1\"/>");
  const TrialImage lit =
      trial.render(scene_text::scene(2, view + shape("rectangle", diffuse(0.5)) + point), settings);
  for (std::size_t c = 0; c < 5; ++c)
    trial.exact("diffuse square, " + short_text(kDecades[c]), lit, c, 0.5 * kDecades[c] / kPi, 2e-6,
                "rounding");
  const TrialImage sky =
      trial.render(scene_text::scene(1, view + emitter("constant", decades("radiance"))), settings);
  for (std::size_t c = 0; c < 5; ++c)
    trial.exact("seen directly, " + short_text(kDecades[c]), sky, c, kDecades[c], 5e-7, "rounding");
  const std::string wide = orthographic(lookat("0, 0, 2", "0, 0, 0"), 1, film(2), 1e-3);
  std::string lamps;
  for (const auto& [x, radiance] : {std::pair{-1.0, 1e15}, {1.0, 1e-20}})
    lamps += shape("rectangle", to_world(translate(x, 0, 0)) + diffuse(0) + lamp(radiance));
  const TrialImage both = trial.render(scene_text::scene(1, wide + lamps), {.samples = settings.samples});
  const double limit = 5e-7 + sum_rounding(both);
  const double left = both.at(0, 0, 0) / 1e-3, right = both.at(1, 0, 0) / 1e-3;
  trial.figure("1e15 beside 1e-20: the brighter, relative", "1", std::max(left, right) / 1e15, 1, limit,
               "rounding");
  trial.figure("1e15 beside 1e-20: the darker, relative", "1", std::min(left, right) / 1e-20, 1, limit,
               "rounding");
  return trial.finish();
}

constexpr uint32_t kColumns = 64, kRows = 33;

/// Rows from the top, as PFM stores them from the bottom.
std::string grey_pfm(const std::vector<float>& image) {
  static_assert(std::endian::native == std::endian::little);
  std::string text = "Pf\n" + std::to_string(kColumns) + " " + std::to_string(kRows) + "\n-1.0\n";
  for (uint32_t y = kRows; y-- > 0;)
    text.append(reinterpret_cast<const char*>(&image[y * kColumns]), kColumns * sizeof(float));
  return text;
}

/// An environment of 1 with one pixel of 1e6. Between pixels radiance is bilinear in the azimuth (columns at
/// (c + 1/2) / W of a turn) and the polar angle (rows at r / (H - 1) of pi): the pixel adds a tent. A diffuse
/// square of reflectance rho facing +Y shows
///   L = rho / pi int L cos dw = rho (1 + (1e6 - 1) / pi dphi int tent(theta) cos(theta) sin(theta) dtheta),
/// dphi = 2 pi / W the area of the tent along the azimuth; the other integral by the midpoint rule. A channel
/// in which D65 is constant to 1e-4 and taken out by an image of the environment itself.
std::vector<HardFigure> one_bright_pixel(const HardCaseContext& context) {
  Trial trial(context);
  const ScratchFolder folder;
  constexpr uint32_t kColumn = 11, kRow = 7;
  std::vector<float> map(kColumns * kRows, 1.0f);
  const std::string light = emitter("envmap", text("filename", "map.pfm"));
  TrialSettings settings{.bands = "500-500.001", .samples = 1, .directory = folder.path()};
  folder.write("map.pfm", grey_pfm(map));
  const std::string view = orthographic(lookat("0, 2, 0", "0, 0, 0", "1, 0, 0"), 1e-3, film(8), 1e-3);
  const TrialImage flat = trial.render(scene_text::scene(1, view + light), settings);
  map[kRow * kColumns + kColumn] = 1e6f;
  folder.write("map.pfm", grey_pfm(map));
  const double step = kPi / (kRows - 1);
  double tent = 0;
  constexpr int kParts = 20000;
  for (int i = 0; i < kParts; ++i) {
    const double theta = (kRow - 1 + 2 * (i + 0.5) / kParts) * step;
    tent += (1 - std::abs(theta / step - kRow)) * std::cos(theta) * std::sin(theta) * 2 * step / kParts;
  }
  const double unit = flat.at(0, 0, 0) / flat.widths_nm[0];  // D65 in this channel
  const double expected = 0.5 * unit * (1 + (1e6 - 1) / kPi * 2 * kPi / kColumns * tent);
  settings.samples = static_cast<uint32_t>(trial.by_effort(64, 512, 8192));
  settings.replicates = 64;
  const std::string ground = shape("rectangle", to_world(rotate(1, 0, 0, -90)) + diffuse(0.5));
  const TrialImage image = trial.render(scene_text::scene(2, view + ground + light), settings);
  trial.statistical("diffuse square under one pixel of 1e6", image, 0, expected, 1e-5);
  return trial.finish();
}

}  // namespace

std::vector<HardCase> radiance_cases() {
  return {{"radiance_range", "radiances from 1e-20 to 1e15", range_of_radiance},
          {"bright_pixel", "an environment with one pixel of 1e6", one_bright_pixel}};
}

}  // namespace kiloband::validation
