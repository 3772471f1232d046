#include "post/signature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiloband {
namespace {

/// Weighted sums over pixels of one image: [mask][band].
using Sums = std::vector<std::vector<double>>;

/// Sum over each mask's pixels of weight times value. A pixel without samples makes the sum NaN.
Sums weighted_sums(CubeReader& cube, const std::vector<const PixelMask*>& masks,
                   const CameraGeometry& camera) {
  const std::size_t bands = cube.info().bands.size(), width = cube.info().width;
  Sums sums(masks.size(), std::vector<double>(bands, 0));
  std::vector<float> row(width * bands);
  std::vector<PixelMask::Rows> rows;
  for (const PixelMask* mask : masks) rows.push_back(mask->rows());
  for (uint32_t y = 0; y < cube.info().height; ++y) {
    bool wanted = false;
    for (const auto& r : rows) wanted = wanted || (r.begin <= y && y < r.end);
    if (!wanted) continue;
    cube.read_rows(y, 1, row, {});
    for (std::size_t m = 0; m < masks.size(); ++m)
      for (uint32_t x = 0; x < width; ++x) {
        if (!masks[m]->at(x, y)) continue;
        const double weight = camera.pixel_weight(x, y);
        for (std::size_t k = 0; k < bands; ++k) sums[m][k] += weight * row[x * bands + k];
      }
  }
  return sums;
}

double total_weight(const PixelMask& mask, const CameraGeometry& camera) {
  double total = 0;
  for (uint32_t y = 0; y < mask.height(); ++y)
    for (uint32_t x = 0; x < mask.width(); ++x)
      if (mask.at(x, y)) total += camera.pixel_weight(x, y);
  return total;
}

/// Mean radiances of all masks and their backgrounds in one image: [mask][band].
struct Radiances {
  Sums object, background;
};

class Measurement {
 public:
  Measurement(const std::vector<SignatureMask>& masks, const CameraGeometry& camera, bool background_cube)
      : masks_(masks), camera_(camera), background_cube_(background_cube) {
    for (const SignatureMask& mask : masks) {
      weights_.push_back(total_weight(mask.pixels, camera));
      surroundings_.push_back(mask.surroundings ? total_weight(*mask.surroundings, camera) : 0);
    }
  }

  Radiances radiances(CubeReader& cube, CubeReader* background) const {
    std::vector<const PixelMask*> objects, around;
    const PixelMask none(cube.info().width, cube.info().height);
    for (const SignatureMask& mask : masks_) {
      objects.push_back(&mask.pixels);
      around.push_back(mask.surroundings ? &*mask.surroundings : &none);
    }
    Radiances result;
    result.object = means(weighted_sums(cube, objects, camera_), weights_);
    if (background) {
      result.background = means(weighted_sums(*background, objects, camera_), weights_);
    } else if (!background_cube_) {
      result.background = means(weighted_sums(cube, around, camera_), surroundings_);
    }
    return result;
  }

  /// m^2: solid angles become areas at the distance of the object.
  double area(std::size_t mask) const {
    return weights_[mask] * (camera_.orthographic ? 1 : masks_[mask].distance_m * masks_[mask].distance_m);
  }

 private:
  static Sums means(Sums sums, const std::vector<double>& weights) {
    for (std::size_t m = 0; m < sums.size(); ++m)
      for (double& sum : sums[m]) sum /= weights[m];
    return sums;
  }

  const std::vector<SignatureMask>& masks_;
  const CameraGeometry& camera_;
  bool background_cube_;
  std::vector<double> weights_, surroundings_;
};

/// The error of function(replicate) over the replicates that have all pixels; NaN without any.
template <class Function>
double error_of(std::size_t replicates, const std::vector<double>& samples, const Function& function) {
  if (replicates < 2) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values(replicates);
  for (std::size_t r = 0; r < replicates; ++r) values[r] = function(r);
  return replicate_error(values, samples);
}

/// Samples of the replicates: of the object, of what is behind it, and of what is made of both.
struct ReplicateWeights {
  std::vector<double> object, background, both;
};

/// Of pairs the variances 1 / n and 1 / m add up.
ReplicateWeights weights_of(const ReplicatedCube& cube, const ReplicatedCube* background) {
  ReplicateWeights weights{cube.samples, cube.samples, cube.samples};
  if (!background || background->samples.size() != cube.samples.size()) return weights;
  weights.background = background->samples;
  for (std::size_t r = 0; r < weights.both.size(); ++r) {
    const double n = weights.object[r], m = weights.background[r];
    weights.both[r] = n > 0 && m > 0 ? n * m / (n + m) : 0;
  }
  return weights;
}

/// Everything about one band of one mask, from the whole image and its replicates.
class BandFigures {
 public:
  BandFigures(const Radiances& whole, const std::vector<Radiances>& parts, const ReplicateWeights& weights,
              std::size_t mask, std::size_t band)
      : whole_(whole), parts_(parts), weights_(weights), mask_(mask), band_(band) {}

  // Errors. L and B are mean radiances of object and background, A the area: L, A L, B and A (L - B) are
  // linear in the image, so that their values in the replicates give their errors. The contrast C = L / B - 1
  // is not; to first order its error is that of (L - (1 + C) B) / B with B in the denominator and C fixed,
  // which is linear.
  BandSignature figures(double area, bool background, bool background_errors) const {
    const std::size_t count = parts_.size(), pairs = background_errors ? count : 0;
    BandSignature result;
    const double l = object(whole_);
    result.radiance = {l, error_of(count, weights_.object, [&](std::size_t r) { return object(parts_[r]); })};
    result.intensity = {area * l, area * result.radiance.error};
    if (!background) return result;
    const double b = behind(whole_), ratio = l / b;
    const auto difference = [&](std::size_t r) { return area * (object(parts_[r]) - behind(parts_[r])); };
    const auto relative = [&](std::size_t r) { return (object(parts_[r]) - ratio * behind(parts_[r])) / b; };
    result.background = {
        b, error_of(pairs, weights_.background, [&](std::size_t r) { return behind(parts_[r]); })};
    result.contrast_intensity = {area * (l - b), error_of(pairs, weights_.both, difference)};
    result.contrast = {ratio - 1, error_of(pairs, weights_.both, relative)};
    return result;
  }

 private:
  double object(const Radiances& r) const { return r.object[mask_][band_]; }
  double behind(const Radiances& r) const { return r.background[mask_][band_]; }

  const Radiances& whole_;
  const std::vector<Radiances>& parts_;
  const ReplicateWeights& weights_;
  std::size_t mask_, band_;
};

/// Those that have all pixels of a mask, and of its background if it has one, in a band.
std::size_t complete_replicates(const std::vector<Radiances>& parts, bool has_background, std::size_t mask,
                                std::size_t band) {
  return static_cast<std::size_t>(std::ranges::count_if(parts, [&](const Radiances& part) {
    const bool behind =
        !has_background || part.background.empty() || !std::isnan(part.background[mask][band]);
    return behind && !std::isnan(part.object[mask][band]);
  }));
}

void check_background(const CubeInfo& info, const CubeInfo& background) {
  bool same = info.width == background.width && info.height == background.height &&
              info.bands.size() == background.bands.size();
  for (std::size_t k = 0; same && k < info.bands.size(); ++k) {
    const Channel &a = info.bands[k].channel, &b = background.bands[k].channel;
    same = a.min_nm == b.min_nm && a.max_nm == b.max_nm && a.name == b.name;
  }
  if (!same) throw InputError("background: must have the size and the channels of the cube");
  const auto camera = info.metadata.find(kCameraKey), behind = background.metadata.find(kCameraKey);
  if (camera != info.metadata.end() && behind != background.metadata.end() &&
      camera->second != behind->second)
    throw InputError("background: has another camera (" + behind->second + ") than the cube (" +
                     camera->second + ")");
}

}  // namespace

std::vector<Signature> measure_signatures(ReplicatedCube& cube, ReplicatedCube* background,
                                          const std::vector<SignatureMask>& masks,
                                          const CameraGeometry& camera) {
  if (background) check_background(cube.mean->info(), background->mean->info());
  const Measurement measurement(masks, camera, background != nullptr);
  const Radiances whole = measurement.radiances(*cube.mean, background ? background->mean.get() : nullptr);
  const bool paired = !background || background->replicates.size() == cube.replicates.size();
  std::vector<Radiances> parts;
  for (std::size_t r = 0; r < cube.replicates.size(); ++r)
    parts.push_back(measurement.radiances(*cube.replicates[r],
                                          background && paired ? background->replicates[r].get() : nullptr));
  const ReplicateWeights weights = weights_of(cube, background);
  std::vector<Signature> result;
  for (std::size_t m = 0; m < masks.size(); ++m) {
    const bool has_background = background || masks[m].surroundings;
    Signature signature{masks[m].label,
                        masks[m].pixels.count(),
                        camera.orthographic ? 0 : masks[m].distance_m,
                        measurement.area(m),
                        has_background,
                        parts.size(),
                        {}};
    for (std::size_t k = 0; k < whole.object[m].size(); ++k) {
      signature.replicates = std::min(signature.replicates, complete_replicates(parts, has_background, m, k));
      signature.bands.push_back(
          BandFigures(whole, parts, weights, m, k).figures(signature.area_m2, has_background, paired));
    }
    result.push_back(std::move(signature));
  }
  return result;
}

}  // namespace kiloband
