// The oracle of deferred evaluation: scalar, double, the formulas of shared/path_vertex.h written down one by
// one. It shares records and spectral tables with the code that it checks and nothing else.
#pragma once

#include <cstddef>
#include <vector>

#include "scene/compile/flat_scene.hpp"
#include "scene/description/derived_channels.hpp"
#include "src_cpu/path/path_buffer.hpp"

namespace kiloband {

/// One path, one wavelength offset, scalar double precision, as plain as it can be. Returns K
/// channel values followed by the derived ones, in W m^-2 sr^-1 (channel_scale undone). A derived channel d
/// is sum_k response_d(lambda_k) share_k value_k (DerivedChannels).
std::vector<double> evaluate_path_reference(const FlatScene& scene, const DerivedChannels& derived,
                                            const cpu::PathBuffer& paths, std::size_t path, double mu);

}  // namespace kiloband
