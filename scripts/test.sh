#!/usr/bin/env bash
# Installs what is missing, checks how the sources are formatted, builds everything and runs all tests; with the preset
# release also a minute of fuzzing.
# Usage: scripts/test.sh [preset]   (release by default; dev, asan, tsan: see CMakePresets.json)
set -euo pipefail
cd "$(dirname "$0")/.."

preset="${1:-release}"
scripts/install_dependencies.sh test
scripts/format.sh --check
bench=ON
case "$preset" in asan | tsan) bench=OFF ;; esac
cmake --preset "$preset" -DKILOBAND_TESTS=ON -DKILOBAND_BENCH="$bench"
cmake --build --preset "$preset"
ctest --preset "$preset" --parallel "$(nproc)"
if [ "$preset" = release ]; then scripts/fuzz.sh 60; fi
