// Bytes that a path takes on the device, by method: what `kiloband info` prints
// (figures 4 and 7 of the DPEPT paper).
#pragma once

#include <cstdint>

#include "src_gpu/path/round_plan.hpp"

namespace kiloband::opencl {

/// Bytes per path in flight.
/// channels    K; only the method pt keeps anything per channel
/// vertices    of a path: the depth; only the dpept methods keep the vertices of the whole path
/// entries_each  arena entries of a vertex: 1, and 1 or 2 more where values are textured, or the path goes through gas
/// features    of the scene: what else its paths keep
uint64_t bytes_per_path(Method method, uint64_t channels, uint64_t vertices, uint64_t entries_each,
                        const SceneFeatures& features);

}  // namespace kiloband::opencl
