// What several backends say of themselves, as one.
#pragma once

#include <span>

#include "render/backend.hpp"

namespace kiloband {

/// The different names, devices, instruction sets and methods, each in the order of the alphabet with " + " between,
/// names with "+": backends of one kind are described like one of them, whose bits they give.
BackendInfo joined_info(std::span<const BackendInfo> infos);

/// Whether their samples have the same bits: they differ in nothing that BackendInfo says.
bool of_one_kind(std::span<const BackendInfo> infos);

/// Adds what another backend has done; the longest launch and the first 16 invalid samples are those of all.
void add_statistics(BackendStatistics& sum, const BackendStatistics& one);

}  // namespace kiloband
