// What an OpenCL device can do at most: bytes per second of a triad, floating-point operations per second.
#pragma once

#include <cstdint>

#include "src_gpu/device/context.hpp"

namespace kiloband::speed {

/// Bytes per second of a = b + s c over three arrays of `bytes` in all; the best of five. The context profiles.
double triad_bandwidth(opencl::DeviceContext& context, uint64_t bytes);

/// Multiply-adds of 8 independent chains of 16 floats in registers, counted as two operations each; the best of five.
double peak_flops(opencl::DeviceContext& context);

}  // namespace kiloband::speed
