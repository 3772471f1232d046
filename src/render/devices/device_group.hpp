// Several backends that render one image together.
#pragma once

#include <memory>
#include <vector>

#include "base/diagnostics.hpp"
#include "render/backend.hpp"

namespace kiloband {

/// A backend of several, made for the same scene and settings. Blocks of an image are handed out to them as they become
/// free. Samples do not depend on who renders them: devices of one kind give the bits of one of them, others those of
/// their kinds, block by block. A device that fails (DeviceError) is left out from then on, with a warning, and its
/// blocks go to the others; an image of one block has one device's work.
/// backends  at least one
/// sink      receives warnings, from one thread at a time
std::unique_ptr<Backend> make_device_group(std::vector<std::unique_ptr<Backend>> backends,
                                           DiagnosticSink sink);

}  // namespace kiloband
