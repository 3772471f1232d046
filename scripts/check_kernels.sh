#!/usr/bin/env bash
# Runs the kernels on all scenes of the zoo under Oclgrind, which reports accesses outside buffers and data races.
# ctest does so for three scenes; this takes some minutes. Usage: scripts/check_kernels.sh [build folder]
set -euo pipefail
cd "$(dirname "$0")/.."

build=${1:-build/release}
cmake --build "$build" --target test_program_opencl
KILOBAND_CHECK_ALL=1 "$build/tests/end_to_end/test_program_opencl" --gtest_filter='Checker.*'
