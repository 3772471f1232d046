#!/usr/bin/env bash
# Formats all C++, OpenCL and JavaScript files that git does not ignore as .clang-format says, with Debian 12's clang-format.
# Usage: scripts/format.sh [--check]   (--check changes nothing: prints the files that differ, each with its first line that
# does, and exits with 1 if there are any)
set -euo pipefail
cd "$(dirname "$0")/.."

version=14
check=false
case "${1:-}" in
  "") ;;
  --check) check=true ;;
  *) echo "usage: scripts/format.sh [--check]" >&2; exit 2 ;;
esac

# Other versions format otherwise: the program that is named for this one comes first.
formatter="$(command -v "clang-format-$version" || command -v clang-format || true)"
if [ -z "$formatter" ]; then
  echo "clang-format is missing: scripts/install_dependencies.sh test" >&2
  exit 2
fi
if [[ "$("$formatter" --version)" != *" version $version."* ]]; then
  echo "clang-format $version is wanted (Debian 12's), $formatter is another: $("$formatter" --version)" >&2
  exit 2
fi

# Where there is no repository (an unpacked archive), all files but those of the build.
list_files() {
  git -c safe.directory="$PWD" ls-files --cached --others --exclude-standard -- '*.cpp' '*.hpp' '*.h' '*.cl' '*.clh' '*.js' 2>/dev/null ||
    find . -path ./build -prune -o -type f -regextype posix-egrep -regex '.*\.(cpp|hpp|h|cl|clh|js)' -print
}
files=()
while IFS= read -r file; do
  if [ -f "$file" ]; then files+=("$file"); fi
done < <(list_files)
if [ ${#files[@]} -eq 0 ]; then echo "there is nothing to format" >&2; exit 2; fi

if ! $check; then
  "$formatter" -i "${files[@]}"
  exit 0
fi

# One run says which files differ, in a tenth of the time that one run for each takes.
if ! messages="$("$formatter" --dry-run "${files[@]}" 2>&1)"; then
  head -n 20 <<<"$messages" >&2
  exit 2
fi
differing="$(sed -n 's/^\(.*\):[0-9]*:[0-9]*: warning: .*/\1/p' <<<"$messages" | sort -u)"
if [ -z "$differing" ]; then exit 0; fi
while IFS= read -r file; do
  line="$({ LC_ALL=C cmp "$file" <("$formatter" "$file") 2>&1 || true; } | sed -n 's/.* line \([0-9]*\)$/\1/p')"
  echo "$file:${line:-1}: $(sed -n "${line:-1}p" "$file")"
done <<<"$differing"
echo "$(wc -l <<<"$differing") files are not as .clang-format says; scripts/format.sh formats them" >&2
exit 1
