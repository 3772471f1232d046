// Renders that are killed at random moments and resumed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kiloband::test {

/// Renders the Cornell box with these options once without a break and without a checkpoint, and then
/// `renders` times with one that is written every few milliseconds: killed (SIGKILL) at random moments, from
/// the start to the end of the program, and resumed until it ends.
/// Expects the bytes of the files of the first.
/// seed  of the moments
void expect_same_files_after_kills(const std::vector<std::string>& options, int renders, uint64_t seed);

}  // namespace kiloband::test
