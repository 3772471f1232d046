#!/usr/bin/env python3
"""Renders scenes with kiloband and with Mitsuba 3 and compares the channel means of the images.

Usage: compare_with_mitsuba.py KILOBAND [-o DIR] [--scenes NAME ...] [--effort X] [--backend cpu|opencl]

KILOBAND is the program. Writes DIR/mitsuba.json, which validation/report/report.py shows. Needs numpy and Mitsuba 3
(`pip install mitsuba`). Both renderers make independent replicates of the same scene file; the test is Welch's over
replicates, Šidák's over channels and scenes: all scenes together raise a false alarm with probability 1e-4 at most. Exit code:
0 if all agree, 1 if one does not, 2 if it could not be done.

Pixels are compared too, by `kiloband compare --no-variances` at the same rate: where something stands in the image.
"""

import argparse
import datetime
import json
import os
import pathlib
import subprocess
import sys
import time

sys.dont_write_bytecode = True  # nothing is left in the source folder

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "report")]

import cubes  # noqa: E402
import numpy  # noqa: E402
import render_mitsuba  # noqa: E402
import welch  # noqa: E402

RATE = 1e-4  # of false alarms, all scenes together
REPLICATES = 32
SIZE = (32, 32)
BANDS = "400:700:8"

# name, scene file, samples per pixel and replicate of ours and theirs at effort 1, what it shows
SCENES = [
    ("cornell_box", HERE.parents[1] / "scenes/cornell_box/cornell_box.xml", 384, 3072, "measured spectra, depth 6"),
    ("metals_and_sky", HERE / "scenes/metals_and_sky.xml", 192, 768, "conductors under a grey environment map"),
    ("glass", HERE / "scenes/glass.xml", 192, 768, "smooth, rough and coloured dielectrics, caustics"),
    ("plastics", HERE / "scenes/plastics.xml", 192, 768, "smooth and rough plastics"),
    ("lamps", HERE / "scenes/lamps.xml", 192, 1536, "seven kinds of lamp, mask, two sides, orthographic camera"),
    ("lens_and_textures", HERE / "scenes/lens_and_textures.xml", 192, 768, "thin lens, textures, black body"),
]


def run(*command):
    """Output of a program; its return code must be 0 or 1."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr.strip() or done.returncode}")
    return done


def render_ours(options, scene_file, spp, cube):
    """Returns [replicate][channel], image means."""
    size = f"{SIZE[0]}x{SIZE[1]}"
    command = [options.kiloband, "render", scene_file, "--bands", BANDS, "--size", size, "--spp", spp * REPLICATES]
    command += ["--replicates", REPLICATES, "--keep-replicates", "--seed", options.seed, "--quiet", "-o", cube]
    run(*command, "--backend", options.backend)
    images = [cubes.read_cube(cube.with_suffix(f".r{r:02d}.hdr")) for r in range(REPLICATES)]
    return numpy.array([image.mean(axis=(0, 1), dtype=float) for image in images])


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


def compare_scene(options, mitsuba, entry, level):
    name, scene_file, ours_spp, theirs_spp, what = entry
    spp = [max(1, round(options.effort * count)) for count in (ours_spp, theirs_spp)]
    folder = options.output / "mitsuba"
    start = time.monotonic()
    ours = render_ours(options, scene_file, spp[0], folder / f"{name}_kiloband.hdr")
    middle = time.monotonic()
    theirs, files = render_theirs(options, mitsuba, scene_file, spp[1], folder / f"{name}_mitsuba.hdr")
    end = time.monotonic()
    result = {"name": name, "what": what, "channels_nm": render_mitsuba.parse_bands(BANDS), "replicates": REPLICATES}
    result |= {"samples_ours": spp[0], "samples_theirs": spp[1], "width": SIZE[0], "height": SIZE[1]}
    result |= {"seconds_ours": middle - start, "seconds_theirs": end - middle}
    result |= welch.compare(ours, theirs, level)
    result["pixels"] = compare_pixels(options, folder / f"{name}_kiloband.hdr", files, level, folder / f"{name}.json")
    result["passed"] = result["passed"] and result["pixels"] is None
    return result


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
        f"{'passed' if result['passed'] else 'FAILED'}  {result['name']:18} p {result['p']:<8.2g} "
        f"all channels {100 * result['difference_all']:+.3f} %  largest {100 * result['largest_difference']:+.3f} %  "
        f"detectable {100 * seen['typical']:.2f} % (worst {100 * seen['largest']:.2f} %)  "
        f"{result['seconds_ours']:.0f} s and {result['seconds_theirs']:.0f} s"
        + (f"  {pixels['name']} p {pixels['p']:.2g}" if pixels else ""),
        flush=True,
    )


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("kiloband", type=pathlib.Path)
    parser.add_argument("-o", dest="output", type=pathlib.Path, default=pathlib.Path("validation_results"))
    parser.add_argument("--scenes", nargs="+", default=[], choices=[entry[0] for entry in SCENES])
    parser.add_argument("--effort", type=float, default=1.0, help="factor of all sample counts")
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--variant", default="scalar_spectral")
    return parser.parse_args()


def main():
    options = parse()
    mitsuba = render_mitsuba.find_mitsuba(options.variant)
    (options.output / "mitsuba").mkdir(parents=True, exist_ok=True)
    chosen = [entry for entry in SCENES if not options.scenes or entry[0] in options.scenes]
    # Half of a scene's rate for its channel means, half for its pixels.
    level = welch.sidak(RATE, 2 * len(chosen))
    record = {
        "format": "kiloband against mitsuba 1",
        "mitsuba": mitsuba.__version__,
        "variant": options.variant,
        "program": run(options.kiloband, "--version").stdout.strip(),
        "backend": options.backend,
        "processor": processor_name(),
        "threads": os.cpu_count(),
        "date": datetime.datetime.now(datetime.timezone.utc).date().isoformat(),
        "command": " ".join(sys.argv[1:]),
        "rate": RATE,
        "scenes": [],
    }
    for entry in chosen:
        record["scenes"].append(compare_scene(options, mitsuba, entry, level))
        print_row(record["scenes"][-1])
        (options.output / "mitsuba.json").write_text(json.dumps(record, indent=1) + "\n")
    return 0 if all(scene["passed"] for scene in record["scenes"]) else 1


if __name__ == "__main__":
    sys.exit(main())
