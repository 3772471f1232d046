#!/usr/bin/env bash
# Runs the portable folder's run_all.sh in a bare Debian 12 (debootstrap, variant minbase) that has PoCL's driver and no OpenCL loader.
# Takes some minutes; no test does. Needs root, debootstrap, and build/release/kiloband-portable.tar.gz (the target portable).
# usage: scripts/check_portable.sh OUT [ROOT [MIRROR]]    ROOT: the bare system, made if it is not there (a temporary one by default);
# MIRROR: of Debian; by default the one that apt is configured with
set -euo pipefail
cd "$(dirname "$0")/.."

[ $# -ge 1 ] || { sed -n '4,5p' "$0" >&2; exit 2; }
out=$1 root=${2:-} mirror=${3:-}
archive=build/release/kiloband-portable.tar.gz
fail() { echo "check_portable: $*" >&2; exit 1; }
[ "$(id -u)" -eq 0 ] || fail "needs root"
command -v debootstrap > /dev/null || fail "missing: debootstrap"
[ -r "$archive" ] || fail "$archive is not there: cmake --build build/release --target portable"
[ -n "$mirror" ] || mirror=$(apt-get indextargets --format '$(SITE) $(CODENAME)' 'Created-By: Packages' | awk '$2 == "bookworm" { print $1; exit }')
[ -n "$mirror" ] || fail "apt is configured with no mirror of bookworm"

temporary=
if [ -z "$root" ]; then
  temporary=$(mktemp -d)
  root=$temporary/root
fi
mounted=()
leave() {
  for place in "${mounted[@]}"; do umount "$place"; done
  [ -z "$temporary" ] || rm -rf --one-file-system "$temporary"
}
trap leave EXIT

[ -x "$root/bin/sh" ] || debootstrap --variant=minbase bookworm "$root" "$mirror" > /dev/null
if [ ! -e "$root/etc/OpenCL/vendors/pocl.icd" ]; then
  DEBIAN_FRONTEND=noninteractive chroot "$root" apt-get install -y -q --no-install-recommends pocl-opencl-icd > /dev/null
fi
for loader in "$root"/usr/lib/x86_64-linux-gnu/libOpenCL.so*; do
  [ ! -e "$loader" ] || fail "$root has an OpenCL loader: $loader"
done
# PoCL asks /sys for processors and memory.
mount -t proc proc "$root/proc" && mounted+=("$root/proc")
mount -t sysfs -o ro sysfs "$root/sys" && mounted+=("$root/sys")

rm -rf "$root/opt/kiloband-portable" "$root/opt/out"
tar xzf "$archive" -C "$root/opt"
here=$root/opt/kiloband-portable
printf 'BM' > "$here/a.bmp"

inside() { chroot "$root" /usr/bin/env -i PATH=/usr/bin:/bin "$@"; }

# Every library of the program is of the folder or of glibc.
loaded=$(inside LD_TRACE_LOADED_OBJECTS=1 /opt/kiloband-portable/bin/kiloband)
if grep 'not found' <<< "$loaded"; then fail "libraries are missing"; fi
echo "libraries of the program that are not the folder's:"
grep -v '/opt/kiloband-portable/' <<< "$loaded" | awk '{ print "    " $1 }'

# A picture that needs OpenImageIO is refused as the machine's fault.
cat > "$here/bmp.xml" << 'END'
<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/><shape type="sphere"><bsdf type="diffuse">
<texture type="bitmap" name="reflectance"><string name="filename" value="a.bmp"/></texture></bsdf></shape></scene>
END
code=0
inside /opt/kiloband-portable/kiloband render /opt/kiloband-portable/bmp.xml --spp 1 -o /tmp/a.exr || code=$?
[ "$code" -eq 3 ] || fail "a BMP picture: exit code $code instead of 3"
rm "$here/a.bmp" "$here/bmp.xml"

code=0
inside /opt/kiloband-portable/run_all.sh /opt/out || code=$?
rm -rf "$out"
cp -r "$root/opt/out" "$out"
ls -l "$out"
files=$(find "$out" -type f | wc -l)
[ "$files" -le 8 ] || fail "$files files in $out, more than 8"
[ -z "$(find "$out" -type f -size +16M)" ] || fail "a file is larger than 16 MB"
exit "$code"
