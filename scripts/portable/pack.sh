#!/usr/bin/env bash
# Makes the portable folder (docs/portable.md): programs, every shared library that they need but glibc's, scenes, licences.
# usage: scripts/portable/pack.sh FOLDER PROGRAM [TEST_PROGRAM...]     PROGRAM finds ../lib (the target kiloband_portable)
# Needs Debian: its packages say whose the libraries are.
set -euo pipefail

folder=$(realpath "$1") program=$(realpath "$2")
shift 2
tests=()
for test in "$@"; do tests+=("$(realpath "$test")"); done
cd "$(dirname "$0")/../.."
glibc='^(linux-vdso|ld-linux-x86-64|lib(c|m|pthread|dl|rt|resolv|util|anl|nsl|mvec))\.so'
# Compiled into the programs, so that no library names them.
headers=(libcli11-dev nlohmann-json3-dev libboost1.74-dev libglm-dev opencl-clhpp-headers opencl-c-headers libjs-dygraphs libgtest-dev)

fail() { echo "pack: $*" >&2; exit 1; }

put_programs() {
  mkdir -p "$folder"/{bin,lib,licences,share/kiloband}
  install -s "$program" "$folder/bin/kiloband"
  for test in "${tests[@]}"; do install -s "$test" "$folder/bin/$(basename "$test")"; done
  install scripts/portable/kiloband.sh "$folder/kiloband"
  install scripts/portable/run_all.sh "$folder/run_all.sh"
  install -m 644 scripts/portable/newer_libraries.sh "$folder/lib/newer_libraries.sh"
  install -m 644 docs/portable.md "$folder/README.md"
}

# "NAME FILE" of every library that the programs load, but glibc's.
list_libraries() {
  local listed
  listed=$(for file in "$program" "${tests[@]}"; do LD_LIBRARY_PATH='' ldd "$file"; done)
  if grep 'not found' <<< "$listed" >&2; then fail "libraries are missing"; fi
  awk '$2 == "=>" { print $1, $3 }' <<< "$listed" | grep -vE "$glibc" | sort -u
}

put_libraries() {
  local name file
  while read -r name file; do
    install -m 644 "$file" "$folder/lib/$name"
    echo "$name $(basename "$(readlink -f "$file")")"
  done > "$folder/lib/versions"
}

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2> /dev/null || true)" = installed ]; }

# The package of each file (a line each). The files may be known by their names or by what these are links to.
owners_of() {
  local files links
  mapfile -t files
  mapfile -t links < <(readlink -f "${files[@]}")
  { dpkg -S "${files[@]}" "${links[@]}" 2> /dev/null || true; } | sed -E 's/^([^:]+)(:[a-z0-9]+)?: /\1 /' > "$folder/.owners"
  for i in "${!files[@]}"; do
    awk -v a="${files[i]}" -v b="${links[i]}" '$2 == a || $2 == b { print $1; found = 1; exit } END { exit !found }' \
      "$folder/.owners" || fail "${files[i]} belongs to no package"
  done
  rm "$folder/.owners"
}

# The copyright file of each Debian package that a library or a header comes from.
put_licences() {
  local package packages
  packages=$(awk '{ print $2 }' | owners_of | sort -u)
  for package in "${headers[@]}"; do
    if is_installed "$package"; then packages+=" $package"; fi
  done
  for package in $packages; do
    [ -r "/usr/share/doc/$package/copyright" ] || fail "no copyright file of $package"
    install -m 644 "/usr/share/doc/$package/copyright" "$folder/licences/$package"
  done
  install -m 644 LICENSE "$folder/licences/kiloband"
  # The texts that they refer to.
  mkdir "$folder/licences/common-licenses"
  cp -L $(grep -hoE '/usr/share/common-licenses/[A-Za-z0-9.-]*[A-Za-z0-9]' "$folder"/licences/* 2> /dev/null | sort -u) \
    "$folder/licences/common-licenses"
}

# What `validate`, `bench` and the tests of kernels read.
put_data() {
  local to=$folder/share/kiloband
  cp -r --parents scenes validation/scenes validation/report validation/mitsuba validation/raysect kernels src/shared "$to"
  rm -rf "$to/scenes/generator"
  find "$to" \( -name '*.cpp' -o -name '*.hpp' -o -name CMakeLists.txt -o -name __pycache__ \) -prune -exec rm -rf {} +
}

rm -rf "$folder"
put_programs
list_libraries > "$folder/.libraries"
put_libraries < "$folder/.libraries"
put_licences < "$folder/.libraries"
rm "$folder/.libraries"
put_data
