// The masks that the options of a signature describe.
#pragma once

#include "app/options/signature_options.hpp"

namespace kiloband {

/// Warns of objects among several that are in no pixel.
/// throws InputError  unknown objects, masks without pixels, no distance, surroundings without pixels
std::vector<SignatureMask> signature_masks(const PlaceOptions& options, CubeReader& cube,
                                           const CameraGeometry& camera, const DiagnosticSink& sink);

}  // namespace kiloband
