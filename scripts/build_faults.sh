#!/usr/bin/env bash
# Builds build/faults, the program with planted faults (validation/faults), from a copy of the sources (scripts/plant_faults.sh), and
# checks it: every fault shows, and without one the images are those of the normal build, bit by bit.
# Usage: scripts/build_faults.sh [NORMAL_PROGRAM]   (build/release/app/kiloband by default; built if it is not there)
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh test
normal=${1:-build/release/app/kiloband}
if [ ! -x "$normal" ]; then
  cmake --preset release
  cmake --build --preset release --target kiloband
fi
scripts/plant_faults.sh
cmake -S build/faults/tree -B build/faults -G Ninja -DCMAKE_BUILD_TYPE=Release -DKILOBAND_FAULTS=ON -DKILOBAND_BENCH=OFF
cmake --build build/faults --target kiloband test_faults test_fault_table
ctest --test-dir build/faults --output-on-failure -R '^(Faults/Visible|FaultPlaces|FaultTable|FaultSelection|FaultKernels)'

out=build/faults/equal
mkdir -p "$out"
compare() {  # options of both renders
  "$normal" render "$@" --size 24x24 --spp 8 --seed 7 -o "$out/normal.hdr" 2> /dev/null
  build/faults/app/kiloband render "$@" --size 24x24 --spp 8 --seed 7 -o "$out/faults.hdr" 2> /dev/null
  cmp "$out/normal.img" "$out/faults.img"
  echo "the same bits: $*"
}
for backend in cpu opencl; do
  compare scenes/cornell_box/cornell_box.xml --bands 400:700:9 --backend "$backend"
  compare scenes/analytic/prism.xml --bands 400:700:6 --backend "$backend" --wavelengths per-path
  compare validation/scenes/flint_ball.xml -D alpha=0.1 --bands 400:700:5 --backend "$backend"
done
