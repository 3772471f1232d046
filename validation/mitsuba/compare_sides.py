#!/usr/bin/env python3
"""Which side of a shape emits, reflects and is the inside of glass: a table of cells by kiloband and by Mitsuba 3.

Usage: compare_sides.py KILOBAND [-o DIR] [--views NAME ...] [--backends cpu,opencl:dpept-batch] [--effort X] [--rate R]

The table (side_scenes.py): OBJ, PLY and serialized meshes with vertex normals that agree with the winding, oppose it, differ
within the mesh, lean, or are absent, rectangles, disks, spheres, cylinders and cubes; face_normals, flip_normals, mirroring
to_world, BSDF of the emitter. Of each cell are compared what is seen of the light itself (hit), what receivers get of it
(sampled), both at max_depth 2 and 3 and from both sides; and the surface under a sky as one-sided diffuse and as glass.

A value differs if it is lit for one and dark for the other, or by Welch's test over replicates: one or more of all values
of a call do so by chance with probability R at most. Writes DIR/sides.json. Needs numpy, SciPy and Mitsuba 3 (`pip install mitsuba scipy`). Exit code: 0 if
nothing differs, 1 if something does, 2 if it could not be done.

Mitsuba's light samples (3.9.1) are not those of its surfaces in two cases, which makes its images wrong there: their density
goes with the cosine to the vertex normal, which is not the area's where normals lean; and of a mirrored cylinder they see
the other side. There values are compared with Mitsuba's BSDF samples alone (integrator `direct`), at max_depth 2.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys
import warnings

sys.dont_write_bytecode = True  # nothing is left in the source folder

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "report")]

import cubes  # noqa: E402
import numpy  # noqa: E402
import render_mitsuba  # noqa: E402
import scipy.stats  # noqa: E402
import side_scenes  # noqa: E402

BAND = "500:600:1"
UNIT = 100  # nm: values are integrals over the band
REPLICATES, SAMPLES = 16, 64
DARK = 0.0012  # less than a tenth of what any receiver gets of a light that faces it, more than of the neighbours'
LIT = 3 * DARK  # between them stand receivers that leaning normals just graze
ROUNDING = 1e-4


def path(max_depth):
    return f'<integrator type="path"><integer name="max_depth" value="{max_depth}"/></integrator>'


BSDF_SAMPLES_ALONE = (
    '<integrator type="direct"><integer name="emitter_samples" value="0"/>'
    '<integer name="bsdf_samples" value="1"/></integrator>'
)


def biased(cell):
    """Whether Mitsuba's light samples are not those of its surface."""
    return cell.mesh.startswith("leaning") or (cell.kind == "cylinder" and cell.transform != "plain")


def views(name, cells):
    """Yields what is rendered of a group of cells: (label, above, XML for us, XML for Mitsuba, pixels by name)."""
    for above in (True, False):
        yield from (surface_views if name == "surfaces" else light_views)(name, cells, above)


def surface_views(name, cells, above):
    for surface in side_scenes.SURFACES:
        text = side_scenes.surface_scene(cells, above, path(3), surface)
        yield surface, above, text, text, {"surface": side_scenes.LIGHT}


def light_views(name, cells, above):
    make = side_scenes.inside_scene if name == "inside" else side_scenes.light_scene
    outer = side_scenes.LOWER if above else side_scenes.UPPER
    pixels = {"hit": side_scenes.LIGHT, "sampled": side_scenes.INNER if name == "inside" else outer}
    for depth in (2,) if biased(cells[0]) else (2, 3):
        ours = theirs = make(cells, above, path(depth))
        if biased(cells[0]):
            theirs = make(cells, above, BSDF_SAMPLES_ALONE)
        yield f"max_depth {depth}", above, ours, theirs, pixels


def run(*command):
    """Output of a program. throws render_mitsuba.Impossible  its return code is not 0"""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise render_mitsuba.Impossible(f"{' '.join(map(str, command))}: {done.stderr.strip() or done.returncode}")
    return done.stdout.strip()


def render_ours(options, backend, file, spp):
    """[replicate][pixel], as radiance. spp: of a replicate."""
    cube = options.output / "ours.hdr"
    name, _, method = backend.partition(":")
    command = [options.kiloband, "render", file, "--bands", BAND, "--spp", spp * REPLICATES, "--replicates", REPLICATES]
    command += ["--keep-replicates", "--seed", options.seed, "--quiet", "-o", cube, "--backend", name]
    run(*command, *(["--method", method] if method else []))
    images = numpy.stack([cubes.read_cube(cube.with_suffix(f".r{r:02d}.hdr")) for r in range(REPLICATES)])
    return images[:, 0, :, 0].astype(float) / UNIT


def render_theirs(options, mitsuba, file, cells, spp):
    size = (side_scenes.width(cells), 1)
    bands = render_mitsuba.parse_bands(BAND)
    images = render_mitsuba.render(mitsuba, file, size, bands, spp, REPLICATES, options.seed + 1)
    return images[:, 0, :, 0].astype(float) / UNIT


def value_p(ours, theirs):
    """Of one value, [replicate] each: Welch's test. What is not finite is a difference; without any error it is equal or not."""
    difference = ours.mean() - theirs.mean()
    if not math.isfinite(difference):
        return 0.0
    if abs(difference) <= ROUNDING * max(1, abs(theirs.mean())):
        return 1.0
    if ours.std() == 0 and theirs.std() == 0:
        return 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of replicates that are nearly equal
        return float(scipy.stats.ttest_ind(ours, theirs, equal_var=False).pvalue)


def compare_view(cells, view, images, level, backend):
    """A record for each value."""
    label, above, _, _, pixels = view
    ours, theirs = images
    for i, cell in enumerate(cells):
        for what, place in pixels.items():
            pixel = side_scenes.CELL * i + place
            column = pixel if above else side_scenes.width(cells) - 1 - pixel
            a, b = ours[:, column], theirs[:, column]
            p = value_p(a, b)
            low, high = sorted((a.mean(), b.mean()))
            yield {
                "cell": cell.name(),
                "value": f"{what}, {label}, from {'above' if above else 'below'}",
                "backend": backend,
                "ours": float(a.mean()),
                "theirs": float(b.mean()),
                "p": p,
                "differs": bool(p < level or (low < DARK and high > LIT)),
            }


def groups_of(options):
    """(name of the view, cells): those that need Mitsuba's BSDF samples apart."""
    for name, cells in side_scenes.table().items():
        if options.views and name not in options.views:
            continue
        for wanted in (False, True):
            for group in side_scenes.groups([cell for cell in cells if biased(cell) == wanted]):
                yield name, group


def count_values(options):
    return sum(len(view[4]) * len(cells) for name, cells in groups_of(options) for view in views(name, cells))


def compare(options, mitsuba):
    options.output.mkdir(parents=True, exist_ok=True)
    side_scenes.write_meshes(options.output)
    # Šidák: of so many tests one or more fail by chance with the rate asked for.
    level = -math.expm1(math.log1p(-options.rate) / (count_values(options) * len(options.backends)))
    spp = max(1, round(options.effort * SAMPLES))
    file = options.output / "scene.xml"
    records = []
    for name, cells in groups_of(options):
        for view in views(name, cells):
            file.write_text(view[3])
            # Without light samples few rays find a small light.
            theirs = render_theirs(options, mitsuba, file, cells, spp * (8 if view[3] != view[2] else 1))
            file.write_text(view[2])
            for backend in options.backends:
                ours = render_ours(options, backend, file, spp)
                records += compare_view(cells, view, (ours, theirs), level, backend)
        print(f"{len(records)} values, {sum(r['differs'] for r in records)} differ: {cells[-1].name()}", flush=True)
    return records


def write_results(options, mitsuba, records):
    result = {
        "format": "kiloband against mitsuba: sides 1",
        "mitsuba": mitsuba.__version__,
        "program": run(options.kiloband, "--version"),
        "backends": options.backends,
        "rate": options.rate,
        "cells": len({record["cell"] for record in records}),
        "values": len(records),
        "differences": [record for record in records if record["differs"]],
        "smallest_p": min(record["p"] for record in records),
    }
    (options.output / "sides.json").write_text(json.dumps(result, indent=1) + "\n")
    for record in result["differences"][:40]:
        print(f"{record['cell']}: {record['value']}, {record['backend']}: {record['ours']:.5g}, Mitsuba {record['theirs']:.5g}")
    print(
        f"Mitsuba {result['mitsuba']}: {result['cells']} cells, {result['values']} values, "
        f"{len(result['differences'])} differ; smallest p {result['smallest_p']:.2g}"
    )


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("kiloband", type=pathlib.Path)
    parser.add_argument("-o", dest="output", type=pathlib.Path, default=pathlib.Path("side_results"))
    parser.add_argument("--views", nargs="+", default=[], choices=list(side_scenes.table()))
    parser.add_argument("--effort", type=float, default=1.0, help="factor of all sample counts")
    parser.add_argument("--backends", type=lambda text: text.split(","), default=["cpu"])
    parser.add_argument("--rate", type=float, default=1e-4, help="of false alarms, all values together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--variant", default="scalar_spectral")
    return parser.parse_args()


def main():
    options = parse()
    mitsuba = render_mitsuba.find_mitsuba(options.variant)
    records = compare(options, mitsuba)
    write_results(options, mitsuba, records)
    return 1 if any(record["differs"] for record in records) else 0


if __name__ == "__main__":
    sys.exit(render_mitsuba.exit_code(main))
