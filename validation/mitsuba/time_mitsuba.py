#!/usr/bin/env python3
"""Times renders of Mitsuba 3, and leaves their images: what `kiloband bench peers` calls.

Usage: time_mitsuba.py SCENE.xml --bands 400:700:8 -o STEM.hdr [--variant llvm_ad_spectral] [--size WxH] [--spp N] [--rounds R] [--seed S]
       time_mitsuba.py --probe [--variant V]     prints the versions as JSON; exit code 2 and the reason if it cannot be used

The scene gets the channels as render_mitsuba.py says. Prints JSON: "load_seconds" of reading the scene; "warm_up_seconds" of the
first render, which compiles (and is thrown away); "seconds" of each of the R renders after it, until the image is in an array.
STEM.r00.hdr ... are their images, by the seeds S + 1 .... Variants llvm_* need LLVM 16 or later (with 14 and 15 Mitsuba ends): what
DRJIT_LIBLLVM_PATH names, else the newest that is found where Debian has them (apt-get install libllvm19).
"""

import argparse
import glob
import json
import os
import pathlib
import platform
import re
import sys
import time

import numpy
import render_mitsuba

sys.dont_write_bytecode = True  # nothing is left in the source folder

OLDEST_LLVM = 16
LLVM_PLACES = ["/usr/lib/*/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*", "/usr/local/lib/libLLVM*.so*"]


def llvm_version(name):
    """19 of libLLVM-19.so, libLLVM.so.19.1; 0 where the name says nothing."""
    found = re.search(r"libLLVM-(\d+)|libLLVM\.so\.(\d+)", name)
    return int(found.group(1) or found.group(2)) if found else 0


def find_llvm():
    """Sets DRJIT_LIBLLVM_PATH unless it is set. throws Impossible  there is no library that is new enough"""
    if os.environ.get("DRJIT_LIBLLVM_PATH"):
        return
    files = [file for place in LLVM_PLACES for file in glob.glob(place)]
    newest = max(files, key=llvm_version, default="")
    if llvm_version(newest) < OLDEST_LLVM:
        raise render_mitsuba.Impossible(f"no LLVM library of version {OLDEST_LLVM} or later (apt-get install libllvm19)")
    os.environ["DRJIT_LIBLLVM_PATH"] = newest


def find(variant):
    if variant.startswith("llvm"):
        find_llvm()
    return render_mitsuba.find_mitsuba(variant)


def timed(action):
    begin = time.perf_counter()
    value = action()
    return value, time.perf_counter() - begin


def measure(mitsuba, options):
    bands = render_mitsuba.parse_bands(options.bands)
    size = [int(edge) for edge in options.size.split("x")]
    text = render_mitsuba.adapted(options.scene, render_mitsuba.spectral_film(size, bands))
    scene, load_seconds = timed(lambda: mitsuba.load_string(text))
    result = {"load_seconds": load_seconds, "seconds": []}
    for r in range(options.rounds + 1):
        seed = (options.seed + r) % 2**32
        image, seconds = timed(lambda: numpy.array(mitsuba.render(scene, spp=options.spp, seed=seed)))
        if r == 0:
            result["warm_up_seconds"] = seconds
            continue
        result["seconds"].append(seconds)
        file = options.output.with_suffix(f".r{r - 1:02d}.hdr")
        render_mitsuba.write_cube(file, image[..., : len(bands)].astype(numpy.float32), bands)
    return result


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--bands", default="400:700:8")
    parser.add_argument("-o", dest="output", type=pathlib.Path)
    parser.add_argument("--variant", default="llvm_ad_spectral")
    parser.add_argument("--size", default="64x64")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--probe", action="store_true", help="print the versions of Mitsuba and what it needs, as JSON")
    options = parser.parse_args()
    if not options.probe and not (options.scene and options.output):
        parser.error("SCENE.xml and -o are needed")
    return options


def main():
    options = parse()
    mitsuba = find(options.variant)
    versions = {"mitsuba": mitsuba.__version__, "variant": options.variant, "llvm": os.environ.get("DRJIT_LIBLLVM_PATH")}
    if options.probe:
        print(json.dumps(versions | {"python": platform.python_version(), "numpy": numpy.__version__}))
        return 0
    print(json.dumps(measure(mitsuba, options)))
    return 0


if __name__ == "__main__":
    sys.exit(render_mitsuba.exit_code(main))
