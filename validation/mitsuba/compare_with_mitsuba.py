#!/usr/bin/env python3
"""Renders scenes with kiloband and with Mitsuba 3 and compares the channel means of the images.

Usage: compare_with_mitsuba.py KILOBAND [-o DIR] [--scenes NAME ...] [--effort X] [--backends cpu,opencl:dpept-batch] [--rate R]
       compare_with_mitsuba.py --probe | --list

KILOBAND is the program; `kiloband validate` calls this script with itself. Writes DIR/mitsuba.json, which
validation/report/report.py shows. Needs numpy, SciPy and Mitsuba 3 (`pip install mitsuba scipy`). Both renderers make independent
replicates of the same scene file, Mitsuba's are held against those of every backend; the test is Welch's over replicates,
Šidák's over channels, scenes and backends: all of a call together raise a false alarm with probability R at most. Exit code:
0 if all agree, 1 if one does not, 2 if it could not be done.

Pixels are compared too, by `kiloband compare --no-variances` at the same rate: where something stands in the image.

--probe prints Mitsuba's version (exit code 2: it is not there), --list the names of the scenes.
"""

import argparse
import datetime
import json
import math
import os
import pathlib
import platform
import subprocess
import sys
import time
import traceback

sys.dont_write_bytecode = True  # nothing is left in the source folder

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "report")]

import cubes  # noqa: E402
import numpy  # noqa: E402
import render_mitsuba  # noqa: E402
import welch  # noqa: E402

RATE = 1e-5  # of false alarms, all comparisons of a call together: the suite's share (validation/suite/error_rates.hpp)
REPLICATES = 32
SIZE = (32, 32)
BANDS = "400:700:8"

# name, scene file, samples per pixel and replicate of ours and theirs at effort 1, what it shows
SCENES = [
    ("cornell_box", HERE.parents[1] / "scenes/cornell_box/cornell_box.xml", 384, 3072, "measured spectra, depth 6"),
    ("metals_and_sky", HERE / "scenes/metals_and_sky.xml", 192, 768, "conductors under a grey environment map"),
    ("glass", HERE / "scenes/glass.xml", 192, 768, "smooth, rough and coloured dielectrics, caustics"),
    ("plastics", HERE / "scenes/plastics.xml", 192, 768, "smooth and rough plastics"),
    ("panes_and_blends", HERE / "scenes/panes_and_blends.xml", 192, 768, "thin dielectrics, blends of every kind"),
    ("lamps", HERE / "scenes/lamps.xml", 192, 1536, "seven kinds of lamp, mask, two sides, orthographic camera"),
    ("bumps", HERE / "scenes/bumps.xml", 192, 768, "bump and normal maps on all shapes, from behind"),
    ("lens_and_textures", HERE / "scenes/lens_and_textures.xml", 192, 768, "thin lens, textures, black body"),
]


def run(*command):
    """Output of a program; its return code must be 0 or 1. throws render_mitsuba.Impossible  it was another"""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise render_mitsuba.Impossible(f"{' '.join(map(str, command))}: {done.stderr.strip() or done.returncode}")
    return done


def backend_arguments(backend):
    """ "opencl:pt" as `kiloband render` wants it."""
    name, _, method = backend.partition(":")
    return ["--backend", name] + (["--method", method] if method else [])


def render_replicates(options, backend, seed, scene_file, bands, spp, replicates, cube, *more):
    """[replicate][line][sample][channel], by kiloband. spp: of a replicate."""
    command = [options.kiloband, "render", scene_file, "--bands", bands, "--spp", spp * replicates, "--replicates", replicates]
    command += ["--keep-replicates", "--seed", seed, "--quiet", "-o", cube, *more]
    run(*command, *backend_arguments(backend))
    return numpy.stack([cubes.read_cube(cube.with_suffix(f".r{r:02d}.hdr")) for r in range(replicates)])


def render_ours(options, backend, scene_file, spp, cube):
    """Returns [replicate][channel], image means. Backends get seeds of their own: what one sees is no repetition of another."""
    seed = (options.seed + options.backends.index(backend)) % 2**64
    size = ("--size", f"{SIZE[0]}x{SIZE[1]}")
    return render_replicates(options, backend, seed, scene_file, BANDS, spp, REPLICATES, cube, *size).mean(axis=(1, 2), dtype=float)


def render_theirs(options, mitsuba, scene_file, spp, cube):
    bands = render_mitsuba.parse_bands(BANDS)
    images = render_mitsuba.render(mitsuba, scene_file, SIZE, bands, spp, REPLICATES, options.seed + 1)
    files = [cube.with_suffix(f".r{r:02d}.hdr") for r in range(REPLICATES)]
    for file, image in zip(files, images):
        render_mitsuba.write_cube(file, image, bands)
    return images.mean(axis=(1, 2), dtype=float), files


def compare_pixels(options, ours, theirs, level, report):
    """Verdict of `kiloband compare`: its failed test with the smallest p, or None for a pass."""
    run(
        options.kiloband,
        "compare",
        ours,
        ",".join(map(str, theirs)),
        "--no-variances",
        "--alpha",
        level,
        "--json",
        report,
    )
    result = json.loads(report.read_text())
    tests = [t for t in result["tests"] if not t["passed"]]
    worst = min(tests, key=lambda t: t["p"], default=None)
    return worst and {"name": worst["name"], "p": worst["p"]}


def compare_backend(options, backend, entry, spp, theirs, level):
    """theirs: image means and files of Mitsuba's replicates."""
    name, scene_file = entry[:2]
    stem = options.output / "mitsuba" / f"{name}_{backend.replace(':', '_')}"
    cube = stem.with_suffix(".hdr")
    start = time.monotonic()
    ours = render_ours(options, backend, scene_file, spp, cube)
    result = {"backend": backend, "samples_ours": spp, "seconds_ours": time.monotonic() - start}
    result |= welch.compare(ours, theirs[0], level)
    result["pixels"] = compare_pixels(options, cube, theirs[1], level, stem.with_suffix(".json"))
    result["passed"] = result["passed"] and result["pixels"] is None
    return result


def compare_scene(options, mitsuba, entry, level):
    """Generates a result per backend."""
    name, scene_file, ours_spp, theirs_spp, what = entry
    spp = [max(1, round(options.effort * count)) for count in (ours_spp, theirs_spp)]
    start = time.monotonic()
    theirs = render_theirs(options, mitsuba, scene_file, spp[1], options.output / "mitsuba" / f"{name}_mitsuba.hdr")
    result = {"name": name, "what": what, "channels_nm": render_mitsuba.parse_bands(BANDS), "replicates": REPLICATES}
    result |= {"samples_theirs": spp[1], "width": SIZE[0], "height": SIZE[1]}
    result["seconds_theirs"] = time.monotonic() - start
    for backend in options.backends:
        yield result | compare_backend(options, backend, entry, spp[0], theirs, level)


def processor_name():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return "unknown"


def print_row(result):
    seen = result["detectable"]
    pixels = result["pixels"]
    print(
        f"{'passed' if result['passed'] else 'FAILED'}  {result['name']:18} {result['backend']:18} p {result['p']:<8.2g} "
        f"all channels {100 * result['difference_all']:+.3f} %  largest {100 * result['largest_difference']:+.3f} %  "
        f"detectable {100 * seen['typical']:.2f} % (worst {100 * seen['largest']:.2f} %)  "
        f"{result['seconds_ours']:.0f} s and {result['seconds_theirs']:.0f} s"
        + (f"  {pixels['name']} p {pixels['p']:.2g}" if pixels else ""),
        flush=True,
    )


def finite(value):
    """JSON has no NaN and no infinities: null."""
    if isinstance(value, dict):
        return {key: finite(v) for key, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def add_options(parser, rate):
    parser.add_argument("--effort", type=float, default=1.0, help="factor of all sample counts")
    parser.add_argument("--backends", type=lambda text: text.split(","), default=["cpu"])
    parser.add_argument("--rate", type=float, default=rate, help="of false alarms, all comparisons together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--variant", default="scalar_spectral")


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("kiloband", type=pathlib.Path, nargs="?")
    parser.add_argument("-o", dest="output", type=pathlib.Path, default=pathlib.Path("validation_results"))
    parser.add_argument("--scenes", nargs="+", default=[], choices=[entry[0] for entry in SCENES])
    add_options(parser, RATE)
    parser.add_argument("--probe", action="store_true", help="print the version of Mitsuba")
    parser.add_argument("--list", action="store_true", help="print the names of the scenes")
    options = parser.parse_args()
    if not (options.kiloband or options.probe or options.list):
        parser.error("no program KILOBAND")
    return options


def new_record(options, mitsuba):
    return {
        "format": "kiloband against mitsuba 2",
        "mitsuba": mitsuba.__version__,
        "variant": options.variant,
        "python": platform.python_version(),
        "numpy": numpy.__version__,
        "program": run(options.kiloband, "--version").stdout.strip(),
        "backends": options.backends,
        "processor": processor_name(),
        "threads": os.cpu_count(),
        "date": datetime.datetime.now(datetime.timezone.utc).date().isoformat(),
        "command": " ".join(sys.argv[1:]),
        "rate": options.rate,
        "scenes": [],
    }


def compare(options, mitsuba):
    (options.output / "mitsuba").mkdir(parents=True, exist_ok=True)
    chosen = [entry for entry in SCENES if not options.scenes or entry[0] in options.scenes]
    # Half of a comparison's rate for its channel means, half for its pixels.
    level = welch.sidak(options.rate, 2 * len(chosen) * len(options.backends))
    record = new_record(options, mitsuba)
    for entry in chosen:
        for result in compare_scene(options, mitsuba, entry, level):
            record["scenes"].append(result)
            (options.output / "mitsuba.json").write_text(json.dumps(finite(record), indent=1) + "\n")
            print_row(result)
    return 0 if all(scene["passed"] for scene in record["scenes"]) else 1


def exit_code(action):
    """What `action` returns; 2 where it cannot be done: Python's own would be that of a disagreement."""
    try:
        return action()
    except render_mitsuba.Impossible as error:
        print(f"{pathlib.Path(sys.argv[0]).name}: {error}", file=sys.stderr)
    except Exception:
        traceback.print_exc()
    return 2


def main():
    options = parse()
    if options.list:
        print("\n".join(entry[0] for entry in SCENES))
        return 0
    mitsuba = render_mitsuba.find_mitsuba(options.variant)
    if options.probe:
        print(mitsuba.__version__)
        return 0
    return compare(options, mitsuba)


if __name__ == "__main__":
    sys.exit(exit_code(main))
