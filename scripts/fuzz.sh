#!/usr/bin/env bash
# Fuzzes the readers of files (tests/fuzz): builds build/fuzz with clang, libFuzzer, ASan and UBSan and runs every target,
# two side by side. Prints a line per target; the inputs of findings are left in build/fuzz/findings, what led to new code
# in build/fuzz/corpus, where the next run takes it up.
# Usage: scripts/fuzz.sh [SECONDS [TARGET...]]   (60 seconds of run time in all, every target)
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-60}
shift || true
scripts/install_dependencies.sh test
[ -f build/fuzz/build.ninja ] || cmake --preset fuzz > /dev/null
cmake --build --preset fuzz
if [ $# -gt 0 ]; then targets=("$@"); else mapfile -t targets < <(ls tests/fuzz/corpus); fi

export out=build/fuzz each=$(((seconds + ${#targets[@]} - 1) / ${#targets[@]}))
mkdir -p "$out/findings" "$out/corpus" "$out/logs"
TMPDIR=$(mktemp -d -p "$([ -d /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")")  # targets write a file per input
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT

run_target() {
  local target=$1 log=$out/logs/$1.txt dictionary=tests/fuzz/dictionaries/$1.dict result=0
  local options=(-seed=1 -max_total_time="$each" -timeout=20 -rss_limit_mb=2048 -malloc_limit_mb=1024 -print_final_stats=1
    -artifact_prefix="$out/findings/$target-")
  [ ! -f "$dictionary" ] || options+=(-dict="$dictionary")
  mkdir -p "$out/corpus/$target"
  KILOBAND_FUZZ_TARGET=$target UBSAN_OPTIONS=print_stacktrace=1 "$out/tests/fuzz/fuzz_inputs" "${options[@]}" "$out/corpus/$target" \
    "tests/fuzz/corpus/$target" > "$log" 2>&1 || result=$?
  local executions edges
  executions=$(sed -n 's/^stat::number_of_executed_units: //p' "$log")
  edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  echo "$target: ${executions:-0} executions, ${edges:-0} edges, $each s, $((result != 0)) findings"
  if [ "$result" -ne 0 ] || [ "${executions:-0}" -eq 0 ]; then
    grep -v ' cov: ' "$log" | tail -60
    touch "$TMPDIR/failed.$target"
  fi
}
export -f run_target
printf '%s\n' "${targets[@]}" | xargs -P 2 -I{} bash -c 'set -u; run_target {}'

failed=$(find "$TMPDIR" -maxdepth 1 -name 'failed.*' | wc -l)
echo "$((${#targets[@]} - failed)) passed, $failed failed"
[ "$failed" -eq 0 ]
