// Where the name of an output leads, and whether two names lead to one file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

namespace kiloband {

/// What stands at the end of a name.
struct OutputTarget {
  std::filesystem::path file;  // behind all symbolic links; need not exist
  int descriptor = -1;         // of ours, that the name stands for (/dev/stdout, /dev/fd/N); otherwise -1
  bool special = false;        // a pipe, a device, an open descriptor: written to, never replaced
  int error = 0;               // errno's value where nothing can be written: a folder, links in a circle ...
};

/// Follows symbolic links to their end, also to one that does not exist yet (as the shell's `>` does).
OutputTarget find_output_target(const std::filesystem::path& name);

/// What two names of one file have in common: device and inode of a file that exists (so that hard links are
/// one, too), otherwise its folder's real path and its name.
/// None for what may be written to more than once: special files.
std::optional<std::string> output_identity(const std::filesystem::path& name);

/// Removes the regular file that a name leads to; links and special files stay. No file is no error.
std::error_code remove_output(const std::filesystem::path& name);

}  // namespace kiloband
