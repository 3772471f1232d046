// Pictures of the conference room: veneer (reflectance, sRGB), and three that emit (linear RGB; times D65
// these are W m^-2 sr^-1 nm^-1, so 1/100 is about 730 cd/m^2): the view outside, the presentation,
// a laptop's desktop.
#include "scenes/generator/conference/conference.hpp"
#include "scenes/generator/implicit.hpp"

namespace kiloband::generator {
namespace {

/// Walnut-like veneer that repeats every metre: streaks along u, matched planks across v.
Image veneer() {
  constexpr int kSize = 512;
  Image image(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double u = static_cast<double>(x) / kSize, v = static_cast<double>(y) / kSize;
      const double turn = 2 * kPi * u;  // periodic in u: a circle in noise space
      const Vec3 around{1.2 * cosine(turn), 1.2 * sine(turn), 0};
      const double plank = std::floor(4 * v), across = 4 * v - plank;
      const double figure = turbulence(around + Vec3{0, 0, 3 * across + 17 * plank}, 5, 3);
      const double rings = sine(2 * kPi * (5 * across + 1.6 * figure));
      const double pores = noise(Vec3{around.x * 6, around.y * 6, 90 * v}, 9);
      double tone = 0.5 + 0.22 * rings + 0.35 * figure + 0.12 * pores;
      tone = clamp(tone + 0.10 * (random_number(77, static_cast<unsigned>(plank)) - 0.5), 0, 1);
      const double gap = across < 0.008 ? 0.6 : 1;
      image.at(x, y) = mix(Vec3{0.36, 0.23, 0.14}, Vec3{0.72, 0.54, 0.38}, tone) * gap;
    }
  }
  return image;
}

/// Overcast sky over a line of trees and a facade, out of focus.
Image view_outside() {
  Image image(256, 96);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double u = static_cast<double>(x) / image.width, v = static_cast<double>(y) / image.height;
      const double cloud = turbulence({6 * u, 3 * v, 0.5}, 30, 3);
      Vec3 colour = mix(Vec3{0.060, 0.074, 0.092}, Vec3{0.098, 0.100, 0.100}, clamp(v + 0.5 * cloud, 0, 1));
      const double line = 0.62 + 0.10 * turbulence({9 * u, 0.3, 2}, 33, 3);
      const Vec3 trees = mix(Vec3{0.010, 0.018, 0.008}, Vec3{0.020, 0.032, 0.012},
                             0.5 + 0.5 * noise({40 * u, 40 * v, 1}, 36));
      colour = mix(colour, trees, smooth_step(line - 0.03, line + 0.05, v));
      image.at(x, y) = colour;
    }
  }
  return image;
}

void fill(Image& image, double x0, double y0, double x1, double y1, Vec3 colour) {
  const auto px = [&](double x) { return static_cast<int>(x * image.width); };
  const auto py = [&](double y) { return static_cast<int>(y * image.height); };
  for (int y = py(y0); y < py(y1); ++y) {
    for (int x = px(x0); x < px(x1); ++x) image.at(x, y) = colour;
  }
}

/// Colours of the visible spectrum for a parameter in [0, 1], violet to red.
Vec3 rainbow(double t) {
  const auto bump = [&](double centre, double width) {
    const double d = (t - centre) / width;
    return exponential(-d * d);
  };
  return {0.9 * bump(0.82, 0.22) + 0.35 * bump(0.05, 0.1), 0.75 * bump(0.5, 0.18), 0.9 * bump(0.22, 0.16)};
}

/// A curve as a band whose half height is `half`, over a filled area.
void plot(Image& image, double base, double height, double half, Vec3 colour, bool filled) {
  for (int x = image.width / 8; x < image.width * 7 / 8; ++x) {
    const double t = (static_cast<double>(x) / image.width - 0.125) / 0.75;
    const double value = 0.25 + 0.55 * exponential(-40 * (t - 0.62) * (t - 0.62)) +
                         0.35 * exponential(-150 * (t - 0.25) * (t - 0.25)) +
                         0.05 * noise({24 * t, 0.5, 0.5}, 50);
    const double top = base - height * value;
    for (int y = 0; y < image.height; ++y) {
      const double v = static_cast<double>(y) / image.height;
      if (std::fabs(v - top) < half) image.at(x, y) = colour;
      if (filled && v > top + half && v < base) image.at(x, y) = mix(image.at(x, y), rainbow(t), 0.75);
    }
  }
}

/// A slide: heading, axes, a spectrum over its colours, lines of text beside. Values in [0, 1].
Image slide() {
  Image image(512, 288, {0.75, 0.78, 0.80});
  fill(image, 0, 0, 1, 0.13, {0.02, 0.06, 0.18});
  fill(image, 0.05, 0.045, 0.52, 0.085, {0.85, 0.88, 0.9});
  fill(image, 0.05, 0.93, 0.22, 0.945, {0.3, 0.33, 0.38});
  plot(image, 0.84, 0.55, 0.008, {0.03, 0.05, 0.12}, true);
  fill(image, 0.12, 0.20, 0.125, 0.85, {0.05, 0.05, 0.06});
  fill(image, 0.12, 0.84, 0.89, 0.85, {0.05, 0.05, 0.06});
  for (int i = 0; i <= 6; ++i)
    fill(image, 0.125 + 0.125 * i, 0.85, 0.129 + 0.125 * i, 0.87, {0.05, 0.05, 0.06});
  for (int i = 0; i < 3; ++i)
    fill(image, 0.60, 0.22 + 0.045 * i, 0.86 - 0.05 * i, 0.235 + 0.045 * i, {0.22, 0.25, 0.32});
  return image;
}

Image scaled(Image image, double factor) {
  for (Vec3& p : image.pixels) p = p * factor;
  return image;
}

}  // namespace

void add_conference_images(Images& images) {
  images["veneer.ppm"] = veneer();
  images["outside.pfm"] = scaled(view_outside(), 0.07);
  images["slide.pfm"] = scaled(slide(), 0.006);
  images["desktop.pfm"] = scaled(slide(), 0.004);
}

}  // namespace kiloband::generator
