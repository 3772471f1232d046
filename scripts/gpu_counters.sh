#!/usr/bin/env bash
# Hardware counters of one OpenCL kernel on an NVIDIA GPU, by Nsight Compute, which itself knows no OpenCL: a launch is written to files and
# repeated under CUDA (gpu_counters/capture.c, replay.py).
# usage: scripts/gpu_counters.sh OUT KERNEL LAUNCH PROGRAM ARGUMENTS...          LAUNCH: which, from 0; REGISTERS=MOST holds ptxas to so many
#   scripts/gpu_counters.sh counters dpept_batch 1 build/release/validation/bench/bench_methods --channels 512 --size 256 --spp 64
# OUT gets KERNEL.txt (sections and all metrics), KERNEL.csv (by instruction) and what was captured: as much as the kernel's buffers.
# Needs cc, OpenCL headers, ncu, ptxas, python3 with cupy, and NVIDIA's OpenCL driver; no build and no test needs it.
set -euo pipefail

[ $# -ge 4 ] || { sed -n '4,5s/^# //p' "$0" >&2; exit 2; }
here=$(cd "$(dirname "$(readlink -f "$0")")/gpu_counters" && pwd)
mkdir -p "$1/captured" && out=$(cd "$1" && pwd)
kernel=$2 launch=$3
shift 3
for tool in cc ncu ptxas python3; do
  command -v "$tool" > /dev/null || { echo "gpu_counters: no $tool" >&2; exit 1; }
done

cc -shared -fPIC -O1 -Wall -Wextra -o "$out/capture.so" "$here/capture.c" -ldl
CAPTURE_KERNEL=$kernel CAPTURE_LAUNCH=$launch CAPTURE_FOLDER=$out/captured LD_PRELOAD=$out/capture.so "$@"
[ -r "$out/captured/launch.json" ] || { echo "gpu_counters: $kernel has not been launched $((launch + 1)) times" >&2; exit 1; }

sections=()
for section in SpeedOfLight ComputeWorkloadAnalysis MemoryWorkloadAnalysis SchedulerStats WarpStateStats Occupancy InstructionStats \
  LaunchStats SourceCounters; do
  sections+=(--section "$section")
done
# The clocks stay as they are: rates are those of a render.
ncu --clock-control none --force-overwrite -o "$out/$kernel" --kernel-name "$kernel" --launch-count 1 "${sections[@]}" \
  python3 "$here/replay.py" "$out/captured" ${REGISTERS:+--registers "$REGISTERS"}
{ ncu --import "$out/$kernel.ncu-rep" --page details; ncu --import "$out/$kernel.ncu-rep" --page raw; } > "$out/$kernel.txt"
ncu --import "$out/$kernel.ncu-rep" --page source --csv > "$out/$kernel.csv"
grep -E 'Duration|Throughput|Hit Rate|Issue Slots Busy|Achieved Occupancy' "$out/$kernel.txt"
