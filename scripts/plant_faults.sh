#!/usr/bin/env bash
# Makes build/faults/tree: a copy of the sources in which validation/faults/patches have planted the faults that the sources themselves
# have none of. What does not change there keeps its time, so that a build of the copy compiles again only what has changed.
# Usage: scripts/plant_faults.sh [--save|--discard] [FOLDER]    (FOLDER/tree is made, build/faults by default)
#   --save     faults were edited in FOLDER/tree: writes validation/faults/patches and added anew from there
#   --discard  drops such edits
set -euo pipefail
export LC_ALL=C

mode=plant
case "${1:-}" in
  --save | --discard) mode="${1#--}"; shift ;;
  -*) echo "usage: scripts/plant_faults.sh [--save|--discard] [FOLDER]" >&2; exit 2 ;;
esac
root="$(cd "$(dirname "$0")/.." && pwd)"
mkdir -p "${1:-$root/build/faults}"
out="$(cd "${1:-$root/build/faults}" && pwd)"
tree="$out/tree"    # the copy with faults
clean="$out/clean"  # the product's code that it was made of
made="$out/made"    # checksums of the copy as it was made, which tell what somebody has edited since
next="$out/next"    # the copy that is being made
cd "$root"

# Product code, by the patch that plants faults in it: cpu:NAME is in cpu.patch, opencl:NAME in opencl.patch, and so on.
declare -A folders=([cpu]="src_cpu" [opencl]="kernels src_gpu" [shared]="src" [program]="app")
product=(src_cpu kernels src_gpu src app)

fail() {
  printf '%s\n' "$@" >&2
  exit 1
}

files_in() {  # paths below a folder, with \0 behind each
  (cd "$1" && find . -type f -printf '%P\0' | sort -z)
}

checksums() {
  files_in "$1" | (cd "$1" && xargs -0 -r sha256sum) | sort
}

differing() {  # paths below $1 that $2 has otherwise, or not at all
  comm -23 <(checksums "$1") <(checksums "$2") | cut -c 67- | sort
}

edited() {  # paths that somebody has changed, added or removed in the copy
  [ ! -f "$made" ] || [ ! -d "$tree" ] || comm -3 <(checksums "$tree") "$made" | sed 's/^\t//' | cut -c 67- | sort -u
}

rejects() {
  find "$tree" -name '*.rej' | sort
}

# ---- --save
check_edits() {
  local file
  [ -f "$made" ] || fail "there is no $tree: scripts/plant_faults.sh makes it"
  [ -z "$(rejects)" ] || fail "not in the copy yet (put it in, remove the files, then --save again):" "$(rejects)"
  for folder in patches added; do
    diff -rq "validation/faults/$folder" "$tree/validation/faults/$folder" > /dev/null ||
      fail "validation/faults/$folder has changed since the copy was made: --save would undo that. Take down your edits of" "$(edited)" \
        "then --discard, and make them again"
  done
  while IFS= read -r file; do
    [[ " ${product[*]} " == *" ${file%%/*} "* ]] ||
      fail "$file was edited in the copy, but is no product code: edit it in the source tree (--discard drops the edit)"
    [[ -f "$tree/$file" || "$file" == *.rej ]] ||
      fail "$file was removed from the copy, which no planted fault may do (--discard brings it back)"
  done < <(edited)
}

save_added() {  # files that the copy alone has
  local folder file
  for folder in "${product[@]}"; do
    if [ ! -d "$tree/$folder" ]; then continue; fi
    files_in "$tree/$folder" | while IFS= read -r -d '' file; do
      if [ -f "$clean/$folder/$file" ]; then continue; fi
      mkdir -p "$(dirname "validation/faults/added/$folder/$file")"
      cp "$tree/$folder/$file" "validation/faults/added/$folder/$file"
    done
  done
}

write_patch() {  # named $1, of the folders $2
  local name="$1" folder file text=""
  for folder in $2; do
    if [ ! -d "$clean/$folder" ]; then continue; fi
    while IFS= read -r file; do
      text+="$(diff -u --label "a/$folder/$file" --label "b/$folder/$file" "$clean/$folder/$file" "$tree/$folder/$file" || true)"$'\n'
    done < <(differing "$clean/$folder" "$tree/$folder")
  done
  if [ -z "$text" ]; then rm -f "validation/faults/patches/$name.patch"; return; fi
  mkdir -p validation/faults/patches
  printf 'Planted faults in %s, as scripts/plant_faults.sh --save has written them.\n%s' "$2" "$text" > "validation/faults/patches/$name.patch"
}

# ---- planting
list_sources() {  # where there is no repository (an unpacked archive), all files but those of the build
  { [ -e .git ] && git -c safe.directory="$root" ls-files -z --cached --others --exclude-standard; } ||
    find . -path ./build -prune -o -type f -printf '%P\0'
}

make_next() {
  rm -rf "$next" "$clean" "$made"
  mkdir -p "$next" "$clean" "$tree"
  list_sources | while IFS= read -r -d '' file; do
    if [ -f "$file" ]; then printf '%s\0' "$file"; fi
  done | tar --create --null --files-from=- | tar --extract --touch --directory="$next"
  for folder in "${product[@]}"; do
    if [ -d "$next/$folder" ]; then cp -r "$next/$folder" "$clean/"; fi
  done
}

plant() {  # a hunk that does not apply is left in FILE.rej
  local file
  whole=true
  for file in validation/faults/patches/*.patch; do
    patch --directory="$next" --strip=1 --fuzz=0 --force --no-backup-if-mismatch --quiet < "$file" >&2 || whole=false
  done
  if $whole; then cp -r validation/faults/added/. "$next/"; fi  # without them CMake refuses KILOBAND_FAULTS
}

install_next() {  # what is the same keeps its time
  local new="$out/new" file
  differing "$next" "$tree" > "$new"
  files_in "$tree" | while IFS= read -r -d '' file; do
    if [ ! -f "$next/$file" ]; then rm "$tree/$file"; fi
  done
  tar --create --directory="$next" --verbatim-files-from --files-from="$new" | tar --extract --touch --directory="$tree"
  checksums "$tree" > "$made"
  echo "$tree: files that are new or have changed: $(wc -l < "$new")"
  rm -r "$next" "$new"
}

case $mode in
  save)
    check_edits
    save_added
    for name in "${!folders[@]}"; do write_patch "$name" "${folders[$name]}"; done
    ;;
  plant)
    [ -z "$(edited)" ] ||
      fail "edited in $tree:" "$(edited)" "scripts/plant_faults.sh --save takes these edits over into validation/faults, --discard drops them"
    ;;
esac
make_next
plant
install_next
$whole ||
  fail "The code around these faults has changed. To repair them, do by hand in the copy what each .rej says, remove it, and then" \
    "scripts/plant_faults.sh --save. Where a file has another name now, write that into the patch instead." \
    "$(rejects | xargs -r grep -H '^@@')"
