// Signatures: radiant intensity and contrast of a set of pixels. docs/signatures.md has the mathematics.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "post/camera_geometry.hpp"
#include "post/pixel_mask.hpp"
#include "post/replicated_cube.hpp"

namespace kiloband {

/// What is to be measured. Not both of `surroundings` and a background cube.
struct SignatureMask {
  std::string label;
  PixelMask pixels;                       // not empty
  std::optional<PixelMask> surroundings;  // whose mean radiance is the background
  double distance_m = 1;                  // from the camera; unused if it is orthographic
};

/// A number with its standard error; NaN where there is no error bar.
struct Figure {
  double value = 0, error = 0;
};

/// Of one band, in the quantity q of the cube (W m^-2 sr^-1 for integrals).
struct BandSignature {
  Figure radiance;    // q, mean over the pixels' projected area
  Figure intensity;   // q m^2: W sr^-1
  Figure background;  // q
  Figure contrast_intensity;
  Figure contrast;  // [1], (radiance - background) / background
};

struct Signature {
  std::string label;
  std::size_t pixels = 0;
  double distance_m = 0;  // 0 if the camera is orthographic
  double area_m2 = 0;     // projected area of the pixels at the object
  bool has_background = false;
  std::size_t replicates =
      0;  // that the errors come from, in the band with the fewest: those that have all pixels
  std::vector<BandSignature> bands;
};

/// background  a cube of the same size and bands rendered without the objects, or null. Its error is
///             included if it has as many replicates as `cube`; otherwise what needs it has no error.
/// throws InputError  the background does not fit
std::vector<Signature> measure_signatures(ReplicatedCube& cube, ReplicatedCube* background,
                                          const std::vector<SignatureMask>& masks,
                                          const CameraGeometry& camera);

/// CSV with one row per mask and band:
///   mask,pixels,distance_m,area_m2,channel,min_nm,max_nm,radiance,intensity
///   [,background,contrast_intensity,contrast]; with error bars each figure is followed by NAME_error.
/// signatures  all with or all without background
void write_signatures(const CubeInfo& info, const std::vector<Signature>& signatures, bool errors,
                      const std::filesystem::path& out);

}  // namespace kiloband
