// Pipes, devices and open descriptors as outputs.
#pragma once

#include "files/output_target.hpp"

namespace kiloband {

/// Writes all bytes of the open file `from` to a special file, from beginning to end; a named pipe waits for
/// its reader. A reader that goes away is an error (EPIPE), not the end of the process.
/// Returns 0 or errno's value.
int copy_to_special_file(int from, const OutputTarget& to);

}  // namespace kiloband
