#!/usr/bin/env python3
"""What a control variate of the wavelength offset mu could gain: how much of the variance of a mean of n samples follows from the mean of their offsets.

The mean offset of each pixel is rendered, not guessed: a sky alone, whose spectrum is a line in wavelength, returns it with the same random numbers.
Pixels, and means of 8x8 pixels, of 32x32 and of the image are regressed on it over seeds, each channel on its own, with the degree of freedom that the
slope costs. A value counts by its variance over its squared mean. The part printed is what remains to be gained with the best slope that there is:
0 where a control variate is useless, negative by chance.

Usage: mu_control.py KILOBAND [--channels 8,32] [--spp 4,16,64] [--seeds 40] [--sampler sobol] SCENE.xml ...
"""
import argparse
import pathlib
import re
import subprocess
import tempfile

import numpy

SIDE = 64  # pixels
FIRST, LAST = 400, 700  # nm
SKY = """<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="40"/><film type="hdrfilm"><rfilter type="box"/></film></sensor>
<emitter type="constant"><spectrum name="radiance" value="300:0, 1300:1"/></emitter></scene>"""


def render(options, scene, channels, spp, seed, folder):
    """One render as [y][x][channel]."""
    out = folder / "out.hdr"
    subprocess.run([options.program, "render", scene, "--bands", f"{FIRST}:{LAST}:{channels}", "--spp", str(spp), "--seed", str(seed),
                    "--size", f"{SIDE}x{SIDE}", "--backend", "cpu", "--sampler", options.sampler, "--wavelengths", "shared",
                    "--replicates", "1", "--quiet", "-o", out], check=True, stderr=subprocess.DEVNULL)
    layout = re.search(r"interleave\s*=\s*(\w+)", out.read_text()).group(1)
    shape, order = {"bsq": ((channels, SIDE, SIDE), (1, 2, 0)), "bil": ((SIDE, channels, SIDE), (0, 2, 1)),
                    "bip": ((SIDE, SIDE, channels), (0, 1, 2))}[layout]
    return numpy.fromfile(out.with_suffix(".img"), numpy.float32).astype(float).reshape(shape).transpose(order)


def blocks(cubes, side):
    """Means over side x side pixels of the cubes [seed][y][x][channel]."""
    seeds, height, width, channels = cubes.shape
    return cubes.reshape(seeds, height // side, side, width // side, side, channels).mean((2, 4))


def explained(values, offsets):
    """The part of the relative variance of values [seed]... that a line in offsets (same shape) explains, unbiased."""
    count = len(values)
    mean = values.mean(0)
    x, z = values - mean, offsets - offsets.mean(0)
    total = (x**2).sum(0)
    rest = total - (x * z).sum(0) ** 2 / (z**2).sum(0)
    weight = 1 / (mean**2 + 1e-3 * values.mean() ** 2)
    return 1 - (weight * rest).sum() / (count - 2) / ((weight * total).sum() / (count - 1))


def numbers(text):
    return [int(word) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--channels", type=numbers, default=[8, 32])
    parser.add_argument("--spp", type=numbers, default=[4, 16, 64])
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--sampler", default="sobol")
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args()
    print("| scene | channels | samples | pixel | 8x8 | 32x32 | image |\n|---|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        sky = folder / "sky.xml"
        sky.write_text(SKY)
        for scene in options.scenes:
            for channels in options.channels:
                for spp in options.spp:
                    values, offsets = (numpy.stack([render(options, which, channels, spp, seed, folder) for seed in range(1, options.seeds + 1)])
                                       for which in (scene, sky))
                    parts = [explained(blocks(values, side), blocks(offsets, side)) for side in (1, 8, 32, SIDE)]
                    print(f"| {pathlib.Path(scene).stem} | {channels} | {spp} | " + " | ".join(f"{100 * part:.1f} %" for part in parts) + " |",
                          flush=True)


if __name__ == "__main__":
    main()
