#!/usr/bin/env bash
# Installs the Debian 12 packages that kiloband is built, tested and looked at with. Needs root or sudo; asks nothing.
# Usage: scripts/install_dependencies.sh [build|test|gallery]   (test, the default, includes what only the tests need; gallery is
# what scripts/gallery.sh draws with besides what is built with)
set -euo pipefail

# libjs-dygraphs: draws the spectra in the page of `kiloband view`, which embeds it.
# openimageio-tools: CMake's description of libopenimageio-dev insists on its programs, without depending on them.
build=(g++ cmake ninja-build pkg-config git ca-certificates
  libembree-dev libtbb-dev libopenexr-dev libopenimageio-dev openimageio-tools libpng-dev libjpeg-dev libglm-dev libpugixml-dev zlib1g-dev libyaml-cpp-dev
  libcli11-dev libfmt-dev nlohmann-json3-dev libhwy-dev libcpp-httplib-dev libturbojpeg0-dev libjs-dygraphs libboost-dev libboost-math-dev
  opencl-headers opencl-clhpp-headers ocl-icd-opencl-dev)
# libclang-rt-dev: libFuzzer and the sanitizers of clang; libomp-dev: OpenMP that ThreadSanitizer can follow (GCC's looks like
# data races to it); llvm: names of functions in their reports; patch: plants faults (scripts/plant_faults.sh); python3-selenium,
# chromium, chromium-driver: the page of `kiloband view` in a browser (tests/end_to_end/viewer).
tests=(libgtest-dev libbenchmark-dev clang clang-format clang-tidy libclang-rt-dev libomp-dev llvm pocl-opencl-icd oclgrind gdal-bin python3-matplotlib
  patch python3-selenium chromium chromium-driver)

packages=("${build[@]}")
case "${1:-test}" in
  build) ;;
  gallery) packages+=(python3-matplotlib) ;;
  *) packages+=("${tests[@]}") ;;
esac

missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then exit 0; fi

echo "installing: ${missing[*]}"
as_root=()
if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
