#pragma once

#include <string>

namespace kiloband {

/// The folder with scenes/ and validation/: share/kiloband beside the program's folder (docs/portable.md), else the sources that
/// it was built from.
std::string source_folder();

}  // namespace kiloband
