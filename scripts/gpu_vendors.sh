#!/usr/bin/env bash
# What other vendors' compilers say of the kernels, without their devices, as two Markdown tables: AMD's (clang's amdgcn target:
# registers, scratch, waves, code) and the way to SPIR-V (clang, llvm-spirv, spirv-val for OpenCL 1.2). Before, every program is checked
# as OpenCL C 1.2 with -pedantic -Werror for both. A specialised program must compile within LIMIT seconds of processor time (60).
# usage: scripts/gpu_vendors.sh [SET...]     SET: diffuse, textured, all (scripts/gpu_feature_sets.sh); by default all three
# Needs clang-14, libclc-14, llvm-spirv-14, spirv-tools; no build and no test needs it. CHIPS="gfx900 gfx1030".
set -euo pipefail
cd "$(dirname "$0")/.."

libclc=/usr/lib/clc/amdgcn--amdhsa.bc
read -ra chips <<< "${CHIPS:-gfx900 gfx1030}"
limit=${LIMIT:-60}
missing=()
for tool in clang-14 llvm-spirv-14 spirv-val spirv-dis; do
  command -v "$tool" > /dev/null || missing+=("$tool")
done
[ -r "$libclc" ] || missing+=("$libclc")
if [ ${#missing[@]} -gt 0 ]; then echo "gpu_vendors: missing: ${missing[*]}" >&2; exit 1; fi
. scripts/gpu_feature_sets.sh

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
front=(clang-14 -x cl -cl-std=CL1.2 -Xclang -finclude-default-header -Ikernels -Isrc -I.)

# timed COMMAND...: its seconds of processor time in $seconds; within the limit
timed() {
  local TIMEFORMAT='%U'
  seconds=$({ time (ulimit -t "$limit" && "$@" 2> "$folder/errors"); } 2>&1) ||
    { cat "$folder/errors" >&2; echo "gpu_vendors: failed, or took more than $limit s: $*" >&2; return 1; }
}

check() { # FILE DEFINES...
  for target in "-target spir64" "-target amdgcn-amd-amdhsa -mcpu=gfx900 -nogpulib"; do
    # shellcheck disable=SC2086
    "${front[@]}" $target -pedantic -Wall -Werror -fsyntax-only "${@:2}" "$1"
  done
}

# amd SET TAG FILE DEFINES...
amd() {
  local set=$1 tag=$2 file=$3 chip
  shift 3
  for chip in "${chips[@]}"; do
    timed "${front[@]}" -target amdgcn-amd-amdhsa -mcpu="$chip" -nogpulib -O3 "$@" -Xclang -mlink-builtin-bitcode \
      -Xclang "$libclc" -Wno-linker-warnings -S -o "$folder/amd.s" "$file"
    python3 scripts/gpu_vendors.py amd "$set" "$tag" "$chip" "$seconds" "$folder/amd.s" >> "$folder/amd.md"
  done
}

# spirv SET TAG FILE DEFINES...: unoptimised, as the translator takes it: a driver optimises what it is given
spirv() {
  local set=$1 tag=$2 file=$3 first
  shift 3
  timed "${front[@]}" -target spir64 -O3 -Xclang -disable-llvm-passes "$@" -emit-llvm -c -o "$folder/spirv.bc" "$file"
  first=$seconds
  timed llvm-spirv-14 --spirv-max-version=1.0 -o "$folder/spirv.spv" "$folder/spirv.bc"
  spirv-val --target-env opencl1.2 "$folder/spirv.spv"
  spirv-dis -o "$folder/spirv.txt" "$folder/spirv.spv"
  python3 scripts/gpu_vendors.py spirv "$set" "$tag" "$first" "$seconds" "$(stat -c %s "$folder/spirv.spv")" "$folder/spirv.txt" >> "$folder/spirv.md"
}

program() { check "${@:3}"; amd "$@"; spirv "$@"; }

[ $# -gt 0 ] || set -- diffuse textured all
# As a GPU is given 512 channels (evaluation_shape): 4 per item; shared wavelengths, no derived channels.
evaluation=(-DKB_WIDTH=4 -DKB_VECTORS=1 -DKB_DERIVED=0 -DKB_PIXELS=1 -DKB_PER_PATH=0)
for set in "$@"; do
  mapfile -t defines < <(defines_of "$set" | tr ' ' '\n')
  [ ${#defines[@]} -gt 0 ] || exit 1
  program "$set" paths kernels/path/paths.cl "${defines[@]}"
  program "$set" batch kernels/evaluate/evaluate.cl "${defines[@]}" "${evaluation[@]}"
  program "$set" path kernels/evaluate/evaluate.cl "${defines[@]}" "${evaluation[@]}" -DKB_FILM_TRANSPOSED=1
  program "$set" pt kernels/evaluate/pt.cl "${defines[@]}" "${evaluation[@]}" -DKB_METHOD_PT=1
done
echo "| set | program | compiled in s | chip | kernel | vector registers | scalar registers | scratch | spills | waves | code |"
echo "|---|---|--:|---|---|--:|--:|--:|--:|--:|--:|"
cat "$folder/amd.md"
echo
echo "| set | program | clang s | llvm-spirv s | bytes | kernels | capabilities |"
echo "|---|---|--:|--:|--:|--:|---|"
cat "$folder/spirv.md"
