#!/usr/bin/env python3
"""Paths per second of kiloband's CPU backend and of Mitsuba 3, by turns in one run, and their channel means.

Usage: compare_speed.py KILOBAND SCENE.xml... [--bands 400:700:8] [--size WxH] [--spp N] [--threads N] [--rounds N] [--robust]

Mitsuba renders with llvm_ad_spectral, whose LLVM must be 16 or later: Debian's libllvm19, named by DRJIT_LIBLLVM_PATH. A path is
one sample of one pixel. Medians over the rounds; the first round of Mitsuba, which compiles, does not count, nor do reading the
scene and writing the image. kiloband traces with Embree's flag ROBUST, without which rays may pass between two triangles;
Mitsuba does only with --robust (https://github.com/mitsuba-renderer/mitsuba3/pull/1300). Means: kiloband's over Mitsuba's, less
1, with the standard error of Mitsuba's, which is that of its rounds. Errors of a pixel, whose squares are variances over the rounds,
averaged over the image: a path of kiloband serves all channels, and so an error is reached that many times sooner (median channel,
least and most; the ratio of variance times seconds).
"""

import argparse
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

import numpy
import render_mitsuba

SAMPLERS = ("independent", "sobol")


def time_kiloband(program, scene, options, sampler, seed, folder):
    """Returns seconds of rendering and the image, [channel][pixel]."""
    output = folder / "image.hdr"
    size = f"{options.size[0]}x{options.size[1]}"
    command = [program, "render", scene, "--backend", "cpu", "--bands", options.bands, "--size", size, "--spp", str(options.spp)]
    command += ["--threads", str(options.threads), "--sampler", sampler, "--seed", str(seed), "-o", str(output)]
    ended = subprocess.run(command, capture_output=True, text=True)
    seconds = re.search(r"paths in ([0-9.]+) s", ended.stderr)
    if ended.returncode != 0 or not seconds:
        sys.exit(f"compare_speed.py: {ended.stderr.strip()}")
    channels = len(render_mitsuba.parse_bands(options.bands))
    return float(seconds.group(1)), numpy.fromfile(output.with_suffix(".img"), "<f4").reshape(channels, -1)


def time_mitsuba(mitsuba, scene, options, seed):
    begin = time.perf_counter()
    image = numpy.array(mitsuba.render(scene, spp=options.spp, seed=seed))
    seconds = time.perf_counter() - begin
    channels = len(render_mitsuba.parse_bands(options.bands))
    return seconds, image[..., :channels].reshape(-1, channels).T


def load(mitsuba, name, options):
    text = render_mitsuba.adapted(name, render_mitsuba.spectral_film(options.size, render_mitsuba.parse_bands(options.bands)))
    if options.robust:
        text = text.replace("</scene>", '<boolean name="embree_use_robust_intersections" value="true"/></scene>')
    return mitsuba.load_string(text)


def means_of(rounds):
    return numpy.array([image.mean(axis=1, dtype=float) for _, image in rounds])


def pixel_error(rounds):
    """The relative error of a pixel, root mean square over the image, by channel."""
    variance = numpy.var([image for _, image in rounds], axis=0, ddof=1, dtype=float).mean(axis=1)
    return numpy.sqrt(variance) / means_of(rounds).mean(axis=0)


def report(scene, options, theirs, ours):
    """theirs: (seconds, image) of each round; ours: the same by sampler"""
    paths = options.size[0] * options.size[1] * options.spp / 1e6
    seconds = [round_[0] for round_ in theirs[1:]]
    print(f"{scene}: Mitsuba {paths / statistics.median(seconds):.2f} million paths per second")
    means, noise = means_of(theirs), pixel_error(theirs)
    error = means.std(axis=0, ddof=1) / len(means) ** 0.5 / means.mean(axis=0)
    for sampler, rounds in ours.items():
        own = [round_[0] for round_ in rounds[1:]]
        ratio = statistics.median(theirs_ / own_ for theirs_, own_ in zip(seconds, own))
        print(f"  kiloband {sampler}: {paths / statistics.median(own):.2f}, ratio {ratio:.2f}")
        difference = means_of(rounds).mean(axis=0) / means.mean(axis=0) - 1
        print("    means, %: " + ", ".join(f"{100 * d:+.2f} ({100 * e:.2f})" for d, e in zip(difference, error)))
        own_noise = pixel_error(rounds)
        sooner = ratio * (noise / own_noise) ** 2
        errors = f"{100 * statistics.median(own_noise):.1f} % beside {100 * statistics.median(noise):.1f} %"
        times = f"{statistics.median(sooner):.1f} times sooner ({min(sooner):.1f} to {max(sooner):.1f})"
        print(f"    error of a pixel: {errors}, {times}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("kiloband")
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--bands", default="400:700:8")
    parser.add_argument("--size", default="256x256", type=lambda text: [int(edge) for edge in text.split("x")])
    parser.add_argument("--spp", type=int, default=128)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--robust", action="store_true")
    options = parser.parse_args()
    try:
        mitsuba = render_mitsuba.find_mitsuba("llvm_ad_spectral")
    except render_mitsuba.Impossible as error:
        sys.exit(f"compare_speed.py: {error}")
    import drjit  # comes with Mitsuba

    drjit.set_thread_count(options.threads)
    for name in options.scenes:
        scene = load(mitsuba, name, options)
        theirs, ours = [], {sampler: [] for sampler in SAMPLERS}
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(options.rounds + 1):
                theirs.append(time_mitsuba(mitsuba, scene, options, seed))
                for sampler, rounds in ours.items():
                    rounds.append(time_kiloband(options.kiloband, name, options, sampler, seed, pathlib.Path(folder)))
        report(pathlib.Path(name).name, options, theirs, ours)


if __name__ == "__main__":
    main()
