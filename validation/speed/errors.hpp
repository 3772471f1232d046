// Errors of images against a reference that has an error itself, at three scales.
//
// x: a channel's value of a unit (a pixel, a tile of 8x8 pixels, the image) in one repetition; r: the reference's; m: the
// reference's mean of the channel over the image. The relative squared error of a repetition is the mean over units of
// ((x - r) / m)^2, of all channels their mean; what the reference adds to it, its own variance over m^2, is
// taken away (without_reference()). The reference's variance comes from its replicates.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "stats/comparison/replicate_image.hpp"
#include "validation/speed/arithmetic.hpp"
#include "validation/speed/subject.hpp"

namespace kiloband::speed {

struct Reference {
  stats::ReplicateImage image;
  std::vector<double> centres_nm;  // of the channels
  uint64_t samples = 0;            // per pixel, all replicates together
  std::string command;
  bool reused = false;  // it was there
};

/// Rendered by the CPU, `shared` and `sobol`, in 16 replicates, by a seed that no case uses; kept in
/// OUTPUT/references under a name that says the scene's fingerprint, and reused as long as that and the number of samples are the same.
/// setup: scene, size, channels and depth
/// throws InputError, DeviceError
Reference reference_of(const Bench& bench, const SceneFile& scene, const Setup& setup, uint64_t samples);

struct ScaleErrors {
  std::string scale;               // "pixel", "tile", "image"
  Estimate square;                 // of all channels together
  std::vector<Estimate> channels;  // square of each
  double reference = 0;            // the part of all channels' that was taken away, before it was
};

/// Channels that are dark in the reference are left out (NaN).
/// throws std::logic_error  the images differ in shape
std::vector<ScaleErrors> errors_of(const Repetitions& repetitions, const Reference& reference);

/// The image's means against the reference's; repetitions >= 2.
struct MeanDifference {
  double relative = 0;  // all channels together
  double error = 0;     // its standard error
  bool differ =
      false;  // some channel's do: Student's t, false alarms at 10^-4 for all channels together (Bonferroni)
};
MeanDifference compare_means(const Repetitions& repetitions, const Reference& reference);

/// Adds what is known of errors: seconds, and per scale the error and the efficiency.
/// common: what all records have in common; channels: also the error of each channel, of pixels and tiles
void add_errors(Bench& bench, const Record& common, const Repetitions& repetitions,
                const Reference& reference, bool channels);

/// Renders independently randomised images as the setup says and adds their errors, of each channel too, to the case
/// `group`; nothing where the run was stopped.
/// subject  made for at least repetitions * setup.replicates replicates
void measure_errors(Bench& bench, const char* group, const SceneFile& scene, Subject& subject,
                    const Setup& setup, uint32_t repetitions, const Reference& reference);

}  // namespace kiloband::speed
