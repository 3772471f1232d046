// The folder in which PoCL keeps what it compiles: without one that can be written it has no device.
#pragma once

#include <filesystem>
#include <string>

namespace kiloband::opencl {

/// PoCL's own choice: $POCL_CACHE_DIR, else $XDG_CACHE_HOME/pocl/kcache, else $HOME/.cache/pocl/kcache, else
/// /tmp/pocl/kcache. Source: pocl_cache_init_topdir() of PoCL 3.1.
std::filesystem::path pocl_cache_folder();

/// Why nothing can be written in `folder`, the nearest part of its path that exists standing for what does
/// not: the system's words, or nothing if all is well. Tried with 1 MiB.
std::string why_not_writable(const std::filesystem::path& folder);

/// To be called before the first OpenCL call. Makes the folder's name absolute (the driver may use it from
/// another current folder); where it cannot be written, POCL_CACHE_DIR becomes a new folder among the
/// temporary files, which vanishes at the end of the process.
void prepare_pocl_cache();

/// What prepare_pocl_cache() found wrong and what was done about it,
/// for users of a PoCL device; empty if nothing.
std::string pocl_cache_problem();

/// Why PoCL cannot build: its folder as it is now, "\nPoCL's folder ... cannot be written: ...";
/// empty if that is not why.
std::string pocl_build_hint();

}  // namespace kiloband::opencl
