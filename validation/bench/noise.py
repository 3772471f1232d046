#!/usr/bin/env python3
"""The noise of two builds of kiloband in the same scenes: variance x time, before over after (more is better for AFTER).

Variance: between renders of different seeds, mean over pixels and channels; relative: of each value over its squared mean (a pixel of a
thousandth of the image's mean and below counts as that), so that dark places count as bright ones. Time: wall clock of a render, median.
Errors: standard deviation over pairs of seeds, a jackknife.

Usage: noise.py BEFORE AFTER [--spp 16] [--seeds 8] [--size 160x120] [--backend cpu] [--sampler sobol] SCENE.xml ...
"""
import argparse
import math
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy


def render(options, program, scene, seed, folder):
    out = folder / "out.hdr"
    start = time.monotonic()
    subprocess.run([program, "render", scene, "--bands", "400:700:4", "--spp", str(options.spp), "--seed", str(seed), "--size", options.size,
                    "--backend", options.backend, "--sampler", options.sampler, "--replicates", "1", "--quiet", "-o", out],
                   check=True, stderr=subprocess.DEVNULL)
    return numpy.fromfile(out.with_suffix(".img"), numpy.float32).astype(float), time.monotonic() - start


def variances(cubes):
    """Of the cubes [seed][value]: the mean variance, and the mean relative variance."""
    mean, variance = cubes.mean(0), cubes.var(0, ddof=1)
    return numpy.array([variance.mean(), (variance / (mean**2 + 1e-3 * mean.mean() ** 2)).mean()])


def jackknife(before, after):
    """Ratios of variances and their standard errors: seeds are left out of both one by one."""
    count = len(before)
    ratio = variances(before) / variances(after)
    left = numpy.array([variances(numpy.delete(before, i, 0)) / variances(numpy.delete(after, i, 0)) for i in range(count)])
    return ratio, numpy.sqrt((count - 1) * ((left - left.mean(0)) ** 2).mean(0))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--sampler", default="sobol")
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args()
    print("| scene | variance | relative variance | time | means apart, in standard errors |\n|---|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as name:
        for scene in options.scenes:
            runs = [[], []]
            for seed in range(1, options.seeds + 1):
                for side, program in enumerate((options.before, options.after)):
                    runs[side].append(render(options, program, scene, seed, pathlib.Path(name)))
            before, after = (numpy.stack([cube for cube, _ in side]) for side in runs)
            ratio, error = jackknife(before, after)
            seconds = [statistics.median(s for _, s in side) for side in runs]
            totals = [cubes.mean(1) for cubes in (before, after)]
            apart = (totals[1].mean() - totals[0].mean()) / math.sqrt(sum(t.var(ddof=1) / options.seeds for t in totals))
            print(f"| {pathlib.Path(scene).name} | {ratio[0]:.2f} ± {error[0]:.2f} | {ratio[1]:.2f} ± {error[1]:.2f} "
                  f"| {seconds[0] / seconds[1]:.2f} | {apart:+.1f} |", flush=True)


if __name__ == "__main__":
    main()
