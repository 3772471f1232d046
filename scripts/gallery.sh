#!/usr/bin/env bash
# Renders the pictures of README's gallery: the scenes that come with the project, each beside the spectrum of a marked pixel.
# Usage: scripts/gallery.sh [OUT_DIR]   (docs/gallery by default; about 15 minutes on two cores)
# Needs root or sudo for what is missing (python3-matplotlib besides what the program is built with).
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh gallery
cmake --preset release -DKILOBAND_TESTS=OFF -DKILOBAND_BENCH=OFF
cmake --build --preset release --target kiloband generate_scenes
exec /usr/bin/python3 scripts/gallery.py build/release "${1:-docs/gallery}"
