#!/usr/bin/env bash
# What a GPU's assembler says of the kernels, without a GPU: registers, stack, spills, warps, instructions, as a Markdown table.
# usage: scripts/gpu_static.sh [SET...]     SET: diffuse (diffuse surfaces, area lights; the default), textured (with conductors,
# dielectrics, plastics, bitmaps, environment map), all, unspecialised (gpu_feature_sets.sh)
# Needs clang-14, llvm-14, libclc-14, and ptxas (12 or later) and nvdisasm in PATH; no build and no test needs it. ARCH=sm_90.
set -euo pipefail
cd "$(dirname "$0")/.."

llvm=/usr/lib/llvm-14/bin libclc=/usr/lib/clc/nvptx64--nvidiacl.bc arch=${ARCH:-sm_90}
missing=()
for tool in clang-14 ptxas nvdisasm "$llvm"/{llvm-nm,llvm-link,opt,llc}; do
  command -v "$tool" > /dev/null || missing+=("$tool")
done
[ -r "$libclc" ] || missing+=("$libclc")
if [ ${#missing[@]} -gt 0 ]; then echo "gpu_static: missing: ${missing[*]}" >&2; exit 1; fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

. scripts/gpu_feature_sets.sh

# assemble NAME FILE DEFINES...  (limit: registers at most, as the host asks for): NAME.cubin and ptxas's report NAME.txt
assemble() {
  local out=$folder/$1 file=$2 kernels
  shift 2
  clang-14 -x cl -cl-std=CL1.2 -Xclang -finclude-default-header -target nvptx64-unknown-nvcl -DFP_FAST_FMAF=1 \
    -cl-fp32-correctly-rounded-divide-sqrt -Dcl_clang_storage_class_specifiers -Ikernels -Isrc -I. -include scripts/nvidia_functions.h "$@" -O3 \
    -Xclang -disable-llvm-passes -Xclang -target-cpu -Xclang sm_75 -Xclang -target-feature -Xclang +ptx75 \
    -emit-llvm -c -o "$out.bc" "$file"
  kernels=$("$llvm/llvm-nm" --defined-only "$out.bc" | awk '$2 == "T" { print $3 }' | paste -sd,)
  "$llvm/llvm-link" -o "$out.linked.bc" "$out.bc" --only-needed "$libclc" 2> /dev/null
  "$llvm/opt" -internalize -internalize-public-api-list="$kernels" -nvvm-reflect -O3 -mtriple=nvptx64-nvidia-nvcl \
    -mcpu=sm_80 -o "$out.opt.bc" "$out.linked.bc"
  "$llvm/llc" -O3 -mtriple=nvptx64-nvidia-nvcl -mcpu=sm_75 -mattr=+ptx75 -o "$out.ptx" "$out.opt.bc"
  ptxas -v ${limit:+--maxrregcount=$limit} -arch="$arch" -o "$out.cubin" "$out.ptx" > "$out.txt" 2>&1 || { cat "$out.txt" >&2; return 1; }
}

# row SET TAG FILE DEFINES...
row() {
  local set=$1 tag=$2 file=$3 name=$1.$2
  shift 3
  assemble "$name" "$file" "$@"
  nvdisasm -c "$folder/$name.cubin" > "$folder/$name.sass"
  python3 scripts/gpu_static.py "$set" "$tag" "$folder/$name.txt" "$folder/$name.sass"
}

# As evaluation_shape() of src_gpu/evaluate/evaluation.cpp has it for 512 channels: registers, vectors of four channels per item, pixels per group.
registers_of() { if [ "$1" = diffuse ]; then echo 120; else echo 96; fi; }
batch_of() { if [ "$1" = diffuse ]; then echo -DKB_VECTORS=4 -DKB_PIXELS=2; else echo -DKB_VECTORS=1 -DKB_PIXELS=1; fi; }

[ $# -gt 0 ] || set -- diffuse
echo "| set | program | kernel | registers | stack | spills | warps | instructions |" \
  "load 4 | load 8 | load 16 | store 4 | store 8 | store 16 | local | constant | FMA | branch |"
echo "|---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
for set in "$@"; do
  defines=$(defines_of "$set")
  # Shared wavelengths, no derived channels; the other methods have one vector.
  evaluation="-DKB_WIDTH=4 -DKB_DERIVED=0 -DKB_PER_PATH=0"
  # shellcheck disable=SC2086
  {
    limit=128 row "$set" paths kernels/path/paths.cl $defines # kPathRegisters of src_gpu/device_state.cpp
    limit=$(registers_of "$set") row "$set" batch kernels/evaluate/evaluate.cl $defines $evaluation $(batch_of "$set") -DKB_STAGED=1
    row "$set" path kernels/evaluate/evaluate.cl $defines $evaluation -DKB_VECTORS=1 -DKB_FILM_TRANSPOSED=1 | grep dpept_path
    row "$set" pt kernels/evaluate/pt.cl $defines $evaluation -DKB_VECTORS=1 -DKB_METHOD_PT=1
  }
done
