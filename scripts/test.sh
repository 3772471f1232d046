#!/usr/bin/env bash
# Installs what is missing, checks how the sources are formatted, builds everything and runs all tests. The preset release takes
# warnings for errors, and looks at the last commit besides: clang-tidy on its files, a minute of fuzzing where it concerns what is fuzzed
# (tests/fuzz/corpus and regressions are read by a test always).
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
  # Which takes a tenth of all this time to build. Without a commit before (a shallow clone) git has an error, and all is fuzzed.
  git diff --quiet HEAD~1 -- src app/options tests/fuzz tests/support cmake CMakeLists.txt CMakePresets.json scripts/fuzz.sh || scripts/fuzz.sh 60
fi
# More than there are processors, since some wait for browsers, devices and time limits; threads that wait leave theirs to other tests.
OMP_WAIT_POLICY=passive ctest --preset "$preset" --parallel "$(($(nproc) + 1))"
