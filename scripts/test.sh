#!/usr/bin/env bash
# Installs what is missing, checks how the sources are formatted, builds everything and runs all tests. The preset release takes
# warnings for errors, and has clang-tidy on the last commit and a minute of fuzzing besides.
# Usage: scripts/test.sh [preset]   (release by default; dev, asan, tsan: see CMakePresets.json)
set -euo pipefail
cd "$(dirname "$0")/.."

preset="${1:-release}"
scripts/install_dependencies.sh test
scripts/format.sh --check
bench=ON
werror=OFF
case "$preset" in asan | tsan) bench=OFF ;; release) werror=ON ;; esac
cmake --preset "$preset" -DKILOBAND_TESTS=ON -DKILOBAND_BENCH="$bench" -DKILOBAND_WERROR="$werror" -DKILOBAND_UNITY=ON
cmake --build --preset "$preset"
if [ "$preset" = release ]; then
  scripts/tidy.sh
  scripts/fuzz.sh 60
fi
# More than there are processors, since some wait for browsers, devices and time limits; threads that wait leave theirs to other tests.
OMP_WAIT_POLICY=passive ctest --preset "$preset" --parallel "$(($(nproc) + 1))"
