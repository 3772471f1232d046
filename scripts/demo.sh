#!/usr/bin/env bash
# Installs what is missing, builds kiloband, renders the Cornell box in 100 channels and says how to look at it.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh build
cmake --preset release -DKILOBAND_TESTS=OFF -DKILOBAND_BENCH=OFF -DKILOBAND_UNITY=ON -DKILOBAND_NATIVE=ON > build.log 2>&1 || { cat build.log; exit 1; }
rm -f build.log
cmake --build --preset release --target kiloband

out=build/demo
mkdir -p "$out"
build/release/app/kiloband render scenes/cornell_box/cornell_box.xml --spp "${SPP:-64}" --variance \
  -o "$out/cornell_box.exr" -o "$out/cornell_box.hdr" --preview "$out/cornell_box.png" --stats "$out/cornell_box.json"

cat <<END

The Cornell box in 100 channels from 400 to 700 nm:
  $out/cornell_box.png       preview in colour: open it with any image viewer
  $out/cornell_box.exr       spectral OpenEXR, mean spectral radiance and its variance: tev, oiiotool --info -v
  $out/cornell_box.hdr/.img  ENVI, channel values: QGIS, gdalinfo $out/cornell_box.img (Debian: gdal-bin)
  $out/cornell_box.json      statistics of the render
Next: build/release/app/kiloband render --help, or the spectrum of the pixel at (128, 128):
  build/release/app/kiloband convert $out/cornell_box.hdr $out/pixel.csv --pixel 128,128
END
