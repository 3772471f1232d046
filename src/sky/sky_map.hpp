// The clear sky as a latitude-longitude map, in the orientation of environment maps: +Y up,
// u = atan2(x, -z) / 2 pi, v = acos(y) / pi, columns texel-centred, rows from pole to pole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sky/clear_sky.hpp"

namespace kiloband {

inline constexpr double kSunRadiusDeg = 0.266;

/// About 170 bands from 0.38 to 20 um, 10 nm wide in the visible and up to 500 nm beyond 14 um.
ChannelList default_sky_bands();

/// Values are meant to be interpolated between texels; irradiances of the interpolated map are those of the
/// model: the direct light is spread over the texels that the disk of the sun covers, and scattered light is
/// scaled band by band.
class SkyMap {
 public:
  /// width >= 8; height >= 5 and odd, so that a row lies on the horizon. with_sun: false leaves the sun's disk out.
  /// throws InputError  otherwise, and for bands beyond 300 nm to 100 um
  SkyMap(const ClearSky& sky, ChannelList bands, uint32_t width, uint32_t height, bool with_sun = true);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  const ChannelList& bands() const { return bands_; }

  /// Mean spectral radiance of the bands, W m^-2 sr^-1 nm^-1, [row][x][band] for rows y0 .. y0 + rows - 1.
  void fill(uint32_t y0, uint32_t rows, std::span<float> out) const;

  // Means over band b on the horizontal plane, W m^-2 nm^-1.
  double direct_normal(std::size_t b) const { return bands_light_[b].direct; }
  double diffuse(std::size_t b) const;  // scattered sunlight
  double thermal(std::size_t b) const { return bands_light_[b].thermal; }

 private:
  struct BandLight {
    double direct = 0, rayleigh = 0, aerosol = 0, reflected = 0, thermal = 0;
    double rayleigh_depth = 0, aerosol_depth = 0;  // vertical, at the band's centre
    double rayleigh_scale = 0, aerosol_scale = 0;  // of the shapes
    double ground = 0;                             // radiance of the ground
  };
  /// A row's geometry. Weights integrate the interpolated map over the upper hemisphere.
  struct Row {
    double elevation_deg = 0, mass = 0;
    double solid_angle = 0;  // of the part of the map that a texel stands for, sr
    double irradiance = 0;   // the same times the cosine to the zenith, upper hemisphere only
    bool sky = false;
    std::vector<float> thermal;  // by band
  };
  /// A texel's part of the direct light, 1/sr.
  struct SunTexel {
    uint32_t x, y;
    double density;
  };

  void check() const;
  Row make_row(uint32_t y) const;
  void add_thermal(Row& row) const;
  void make_bands();
  void scale_shapes();
  void spread_sun();
  double cosine_to_sun(uint32_t x, const Row& row) const;
  double brightness(const BandLight& band, double mass) const;

  const ClearSky& sky_;
  ChannelList bands_;
  uint32_t width_, height_;
  double sun_mass_;
  std::vector<BandLight> bands_light_;
  std::vector<Row> rows_;
  std::vector<SunTexel> sun_;
};

}  // namespace kiloband
