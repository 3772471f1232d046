#include "scenes/generator/sky.hpp"

#include "scenes/generator/implicit.hpp"

namespace kiloband::generator {
namespace {

/// Direction of a pixel of the environment, as the renderer maps it: the left edge is -z,
/// the middle +z, +x between them.
Vec3 direction(const Image& image, int x, int y) {
  const double phi = 2 * kPi * (x + 0.5) / image.width, theta = kPi * (y + 0.5) / image.height;
  return {sine(theta) * sine(phi), cosine(theta), -sine(theta) * cosine(phi)};
}

}  // namespace

Image clear_sky(Vec3 sun, double clouds) {
  Image image(512, 256);
  sun = normalize(sun);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3 d = direction(image, x, y);
      const double up = clamp(d.y, 0, 1), towards = dot(d, sun);
      Vec3 colour = mix(Vec3{0.075, 0.082, 0.088}, Vec3{0.012, 0.026, 0.062}, power(up, 0.55));
      const Vec3 plane = d * (1 / (up + 0.12));
      const double cloud =
          smooth_step(0.0, 0.9, turbulence({1.1 * plane.x, 0.5, 1.1 * plane.z}, 300, 5) + 0.15);
      colour = mix(colour, {0.105, 0.105, 0.104}, cloud * smooth_step(0.02, 0.25, up) * clouds);
      const double halo = exponential(-14 * (1 - towards));
      colour =
          colour + Vec3{0.16, 0.14, 0.11} * halo + Vec3{34, 30, 24} * smooth_step(0.9968, 0.9986, towards);
      const Vec3 haze{0.030, 0.034, 0.032};  // below the horizon, where the land ends
      image.at(x, y) = mix(haze, colour, smooth_step(-0.01, 0.01, d.y));
    }
  }
  return image;
}

}  // namespace kiloband::generator
