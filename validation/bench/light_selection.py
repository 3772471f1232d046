#!/usr/bin/env python3
"""Lights chosen by power against the light tree: 1 / (variance x time), in halls of many lamps or in scenes that are given.

A hall of 20 x 20 x 3 m has N square lamps of random size and tilt, one mesh of 2 N triangles, each shining downwards, twelve balls, two coloured
walls, and a camera that does not see the lamps themselves. Variance: half the mean squared difference of two renders of different seeds,
means over pixels and channels; time: of a third one, wall clock, with loading and building the tree.

Usage: light_selection.py KILOBAND [--lights 8,128,1000,50000] [--spp 64] [--backend cpu] [--repeat 3] [SCENE.xml ...]
"""
import argparse
import math
import pathlib
import random
import statistics
import subprocess
import tempfile
import time

import numpy


def write_lamps(path, count):
    rng = random.Random(5)
    corners, faces = [], []
    for _ in range(count):
        x, y, z = rng.uniform(-9.5, 9.5), rng.uniform(-9.5, 9.5), rng.uniform(1.5, 2.9)
        size = 1.2 / math.sqrt(count) * rng.uniform(0.3, 1.5)
        turn, tilt = rng.uniform(0, 2 * math.pi), rng.uniform(-0.8, 0.8)
        first = len(corners) + 1
        for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1)):
            u = size * (a * math.cos(turn) - b * math.sin(turn))
            v = size * (a * math.sin(turn) + b * math.cos(turn))
            corners.append((x + u, y + v, z + tilt * u))
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    lines = ["v %.6f %.6f %.6f" % corner for corner in corners] + ["f %d %d %d" % face for face in faces]
    path.write_text("\n".join(lines) + "\n")


WALL = """<shape type="rectangle"><transform name="to_world">%s</transform><ref id="%s"/></shape>"""
HALL = """<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="4"/><boolean name="hide_emitters" value="true"/></integrator>
<sensor type="perspective"><float name="fov" value="70"/>
<transform name="to_world"><lookat origin="-8, -8, 1.7" target="0, 0, 0.9" up="0, 0, 1"/></transform>
<film type="specfilm"><integer name="width" value="192"/><integer name="height" value="128"/>
<spectrum name="all" value="400:1, 700:1"/></film></sensor>
<bsdf type="diffuse" id="grey"><spectrum name="reflectance" value="380:0.5, 780:0.6"/></bsdf>
<bsdf type="diffuse" id="red"><spectrum name="reflectance" value="380:0.1, 600:0.2, 780:0.7"/></bsdf>
%s
<shape type="obj"><string name="filename" value="%s"/><boolean name="face_normals" value="true"/><ref id="grey"/>
<emitter type="area"><spectrum name="radiance" value="380:30, 780:40"/></emitter></shape></scene>
"""


def write_hall(folder, count):
    write_lamps(folder / f"lamps{count}.obj", count)
    parts = [WALL % ('<scale value="10"/>', "grey"),
             WALL % ('<rotate x="1" angle="180"/><scale value="10"/><translate z="3"/>', "grey"),
             WALL % ('<scale x="10" y="1.5"/><rotate x="1" angle="90"/><translate y="10" z="1.5"/>', "red"),
             WALL % ('<scale x="1.5" y="10"/><rotate y="1" angle="-90"/><translate x="10" z="1.5"/>', "red")]
    rng = random.Random(6)
    for _ in range(12):
        parts.append('<shape type="sphere"><point name="center" x="%.3f" y="%.3f" z="0.5"/><float name="radius" value="0.5"/>'
                     '<ref id="red"/></shape>' % (rng.uniform(-7, 7), rng.uniform(-7, 7)))
    path = folder / f"hall{count}.xml"
    path.write_text(HALL % ("\n".join(parts), f"lamps{count}.obj"))
    return path


def render(options, scene, selection, seed, folder):
    out = folder / f"{selection}{seed}.hdr"
    start = time.monotonic()
    subprocess.run([options.kiloband, "render", scene, "--bands", "400:700:8", "--spp", str(options.spp), "--seed", str(seed),
                    "--light-selection", selection, "--backend", options.backend, "--replicates", "1", "--quiet", "-o", out],
                   check=True)
    return out.with_suffix(".img"), time.monotonic() - start


def measure(options, scene, selection, folder):
    cubes = [numpy.fromfile(render(options, scene, selection, seed, folder)[0], numpy.float32).astype(float) for seed in (1, 2)]
    seconds = statistics.median(render(options, scene, selection, 3 + i, folder)[1] for i in range(options.repeat))
    mean = 0.5 * (cubes[0].mean() + cubes[1].mean())
    return mean, numpy.mean((cubes[0] - cubes[1]) ** 2) / 2, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kiloband")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--lights", default="8,128,1000,50000")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--backend", default="cpu", choices=["cpu", "opencl"])
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    print("| scene | rms error / mean: power | tree | time of tree / power | 1 / (variance x time) of tree / power |")
    print("|---|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenes = options.scenes or [write_hall(folder, int(n)) for n in options.lights.split(",")]
        for scene in scenes:
            (mean, by_power, slow), (_, by_tree, fast) = (measure(options, scene, s, folder) for s in ("power", "tree"))
            print("| %s | %.4f | %.4f | %.2f | %.2f |" % (pathlib.Path(scene).stem, by_power ** 0.5 / mean, by_tree ** 0.5 / mean,
                                                          fast / slow, by_power * slow / (by_tree * fast)), flush=True)


if __name__ == "__main__":
    main()
