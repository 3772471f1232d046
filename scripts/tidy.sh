#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on the C++ files that differ from a commit: what a change may have broken.
# Usage: scripts/tidy.sh [COMMIT]    (the last one's parent by default; --all: every file). Needs build/release, whose generated headers it reads.
set -euo pipefail
cd "$(dirname "$0")/.."

base="${1:-HEAD~1}"
if [ "$base" = --all ]; then
  list=(git ls-files)
elif git rev-parse -q --verify "$base^{commit}" >/dev/null; then
  list=(git diff --name-only --diff-filter=d "$base")
else
  echo "tidy: no commit $base to compare with (a shallow clone?): nothing was looked at"
  exit 0
fi
# Highway's files include themselves once per instruction set, which clang-tidy cannot follow; what is not built is not looked at.
# Commands of single files without precompiled headers, which are of another compiler; so each file is also seen to include what it needs.
cmake -S . -B build/release/tidy -G Ninja -DCMAKE_BUILD_TYPE=Release -DKILOBAND_TESTS=ON -DKILOBAND_BENCH=ON -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON > build/release/tidy.log ||
  { cat build/release/tidy.log; exit 1; }
mapfile -t files < <("${list[@]}" -- '*.cpp' |
  while read -r file; do ! grep -q 'hwy/foreach_target.h' "$file" && grep -q "/$file\"" build/release/tidy/compile_commands.json && echo "$file"; done || true)
if [ ${#files[@]} -eq 0 ]; then exit 0; fi
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy -p build/release/tidy --quiet \
  --extra-arg=-Wno-error --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-ignored-optimization-argument 2>&1 |
  { grep -v '^[0-9]* warnings\? generated\|^Suppressed\|^Use -header-filter' || true; }
exit "${PIPESTATUS[1]}"
