#!/usr/bin/env bash
# Tries what the portable folder has on this machine, within 9 minutes or SECONDS: devices, images of both backends, tests of kernels, `validate
# --quick`, `bench --quick`. OUT gets index.html and JSON files. Goes on after a failure; exit code 1 if there was one.
# usage: ./run_all.sh OUT [SECONDS]          OCL_ICD_VENDORS, a folder or a file, chooses the OpenCL drivers
set -uo pipefail
unset CDPATH  # with it `cd` prints

{ [ $# -eq 1 ] || [ $# -eq 2 ]; } && [[ ${2:-525} =~ ^[1-9][0-9]*$ ]] && [ "${2:-525}" -ge 120 ] ||
  { echo "usage: $0 OUT [SECONDS, at least 120]" >&2; exit 2; }
mkdir -p -- "$1" && out=$(cd -- "$1" && pwd) && trial=$(mktemp -p "$out") && rm "$trial" || exit 2
for name in index.html run.json tests.json validate.json validate.html bench.json bench.html; do
  [ ! -d "$out/$name" ] || { echo "$0: $out/$name is a folder" >&2; exit 2; }
done
here=$(cd "$(dirname "$(readlink -f "$0")")" && pwd)
data=$here/share/kiloband
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT  # which the step gets, too: timeout --foreground leaves it in the terminal's group
export XDG_CACHE_HOME=$work/cache POCL_CACHE_DIR=$work/pocl KILOBAND_SOURCES=$data
mkdir -p "$XDG_CACHE_HOME" "$POCL_CACHE_DIR"
seconds_for_all=${2:-525} failures=0 steps=0 lost=0
# What is left for `validate` and `bench`, whatever comes before; below, for `bench`.
reserve=$((seconds_for_all * 65 / 100))
SECONDS=0

html() { sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g' "$@"; }
json_lines() { sed 's/\\/\\\\/g; s/"/\\"/g; s/\t/ /g; s/^/"/; s/$/"/' "$1" | paste -sd, ; }

# step NAME LIMIT COMMAND...: at most LIMIT seconds; interrupted then, so that what there is gets written.
step() {
  local name=$1 limit=$2 left=$((seconds_for_all - reserve - SECONDS)) begin code word
  shift 2
  steps=$((steps + 1))
  [ "$limit" -le "$left" ] || limit=$left
  begin=$(date +%s.%N)
  if [ "$limit" -ge 5 ]; then
    (cd "$work" && timeout --foreground -s INT -k 15 "$limit" "$@") > "$work/log" 2>&1
    code=$?
  else
    code=124 limit=0
    echo "no time was left" > "$work/log"
  fi
  word=passed
  [ "$code" -eq 0 ] || { word=FAILED; failures=$((failures + 1)); }
  if [ "$code" -eq 124 ] && [ "$limit" -gt 0 ]; then echo "(stopped after $limit s)" >> "$work/log"; fi
  local took
  took=$(awk -v a="$begin" -v b="$(date +%s.%N)" 'BEGIN { printf "%.1f", b - a }')
  printf '%-7s %6s s  %s (exit code %s)\n' "$word" "$took" "$name" "$code"
  [ "$word" = passed ] || tail -n 20 "$work/log" | sed 's/^/        /'
  printf '%s{"step": "%s", "passed": %s, "exit_code": %s, "seconds": %s}' "$([ $steps -gt 1 ] && echo ', ')" "$name" \
    "$([ "$word" = passed ] && echo true || echo false)" "$code" "$took" >> "$work/steps"
  { echo "<h2 class=\"$word\">$name: $word, $took s</h2><pre>"; html "$work/log"; echo "</pre>"; } >> "$work/body"
  return "$code"
}

# test_step NAME LIMIT: a test program, whose results go into tests.json.
test_step() {
  step "$1" "$2" env LD_LIBRARY_PATH="$here/lib" "$here/bin/$1" --gtest_brief=1 "--gtest_output=json:$work/$1.json"
  [ -r "$work/$1.json" ] || return
  printf '%s"%s": ' "$([ -s "$work/tests" ] && echo ', ')" "$1" >> "$work/tests"
  cat "$work/$1.json" >> "$work/tests"
}

image_step() { # NAME CHANNELS OPTIONS...: the Cornell box
  local name=$1 channels=$2
  shift 2
  step "image: $name" 60 "$here/kiloband" render "$data/scenes/cornell_box/cornell_box.xml" --bands "400:700:$channels" --quiet "$@"
}

# Every case of `validate` in a process of its own, within SECONDS, for its programs alone: what it finds is found again.
compile_case() { # END PROGRAM BACKENDS CASE
  local left=$(($1 - $(date +%s)))
  [ "$left" -gt 0 ] || return 0
  timeout --foreground -s INT -k 5 "$left" "$2" validate "$4" --quick --quiet --no-report --backends "$3" -o "ahead/$4" > /dev/null 2>&1 || true
}
compile_ahead() { # SECONDS PROGRAM BACKENDS
  "$2" validate --list 2> /dev/null > cases || return
  OMP_NUM_THREADS=2 xargs -P "$(nproc)" -a cases -I '{}' bash -c 'compile_case "$@"' - "$(($(date +%s) + $1))" "$2" "$3" '{}'
  echo "$(find ahead -name results.json | wc -l) of $(wc -l < cases) cases were begun"
  rm -rf ahead
}
export -f compile_case compile_ahead

# bench.csv as a table; fields in quotes may have commas.
table() {
  html "$1" | awk 'BEGIN { print "<table>" } {
    cell = ""; quoted = 0; row = "<tr>"
    for (i = 1; i <= length($0); ++i) {
      c = substr($0, i, 1)
      if (c == "\"") quoted = !quoted
      else if (c == "," && !quoted) { row = row "<td>" cell "</td>"; cell = "" }
      else cell = cell c
    }
    print row "<td>" cell "</td></tr>" } END { print "</table>" }'
}

echo "kiloband on $(uname -srm), glibc $(getconf GNU_LIBC_VERSION 2> /dev/null | cut -d' ' -f2), $(nproc) processors"
step "devices" 60 "$here/kiloband" devices
cp "$work/log" "$work/devices"
sed 's/^/        /' "$work/devices"
image_step "first, CPU" 100 --backend cpu --spp 1 -o first_cpu.exr
image_step "CPU" 16 --backend cpu --spp 16 --variance -o cpu.hdr --preview cpu.png
if grep -qE '^ *[0-9]+ ' "$work/devices"; then
  image_step "first, OpenCL" 100 --backend opencl --spp 1 -o first_opencl.exr
  for method in dpept-batch dpept-path pt; do
    image_step "$method" 16 --backend opencl --method "$method" --seed 2 --spp 16 --variance -o "$method.hdr"
    step "compare: CPU and $method" 40 "$here/kiloband" compare cpu.hdr "$method.hdr"
  done
  for test in test_gpu_lights test_gpu_bsdf test_gpu_bvh; do
    [ ! -x "$here/bin/$test" ] || test_step "$test" 60
  done
fi
reserve=$((seconds_for_all * 17 / 100))
# Every method where there is a GPU; OpenCL on processors is too slow for more than one in the time.
backends=cpu,opencl:dpept-batch
if grep -qwi gpu "$work/devices"; then
  backends=cpu,opencl:dpept-batch,opencl:dpept-path,opencl:pt
  # A GPU's driver compiles for seconds, one program of a process after the other: cases side by side fill the cache of programs.
  ahead=$(((seconds_for_all - reserve - SECONDS) / 3))
  [ "$ahead" -le 110 ] || ahead=110
  step "programs of validate" $((ahead + 10)) bash -c 'compile_ahead "$@"' - "$ahead" "$here/kiloband" "$backends"
fi
step "validate --quick" 300 "$here/kiloband" validate --quick --quiet --backends "$backends" -o validate
reserve=0
step "bench --quick" 240 "$here/kiloband" bench --quick --quiet -o bench

for pair in validate/results.json:validate.json validate/report.html:validate.html bench/bench.json:bench.json bench/report.html:bench.html; do
  [ ! -r "$work/${pair%:*}" ] || cp "$work/${pair%:*}" "$out/${pair#*:}" || lost=1
done
{ echo "{"; cat "$work/tests" 2> /dev/null; echo "}"; } > "$out/tests.json" || lost=1
printf '{"seconds": %s, "failures": %s, "devices": [%s], "steps": [%s]}\n' "$SECONDS" "$failures" "$(json_lines "$work/devices")" \
  "$(cat "$work/steps")" > "$out/run.json" || lost=1
{
  echo '<!DOCTYPE html><meta charset="utf-8"><title>kiloband here</title><style>body { font: 14px sans-serif; margin: 2em }'
  echo 'pre { background: #eee; padding: 0.5em } .FAILED { color: #b00 } table { border-collapse: collapse; font-size: 12px }'
  echo 'td { border: 1px solid #ccc; padding: 1px 4px }</style><h1>kiloband</h1>'
  echo "<p>$(uname -srm | html), $(nproc) processors, $SECONDS s, $failures of $steps steps failed.</p>"
  cat "$work/body"
  [ ! -r "$work/bench/bench.csv" ] || { echo "<h2>Numbers of bench</h2>"; table "$work/bench/bench.csv"; }
} > "$work/index.html"
cp "$work/index.html" "$out/index.html" || lost=1
[ "$lost" -eq 0 ] || echo "not all results could be written into $out" >&2
echo "$failures of $steps steps failed, $SECONDS s; $out/index.html"
[ "$failures" -eq 0 ] && [ "$lost" -eq 0 ]
