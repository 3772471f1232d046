#!/usr/bin/env python3
"""Folders of scene files by kiloband and by Mitsuba 3: which load, and whether the images agree. Writes a table.

Usage: compare_scenes.py KILOBAND [FOLDER ...] [--elements] [-o DIR] [--only NAME ...] [--aim BIAS] [--most N] [--rate R]

Every *.xml below the folders whose root is <scene> and that has a sensor; with --elements also the scenes of element_scenes.py, which
use each element of Mitsuba's documentation. A scene that both load is rendered by both, with its film replaced by one of 16 x 16
pixels, box filter and 4 channels from 400 to 700 nm, in 32 replicates each, and compared as by `kiloband compare --no-variances`:
pixels, tiles, image. A first run of few samples says how many show the bias that is aimed at; it does not count. DIR/scenes.md has a
row for each scene, DIR/scenes.json the same in numbers. With `differs` an element table says that a difference is known, and why.

Exit code: 0 if every scene agrees, is refused, or differs where that is known; 1 if not; 2 if it could not be done.
Needs numpy and Mitsuba 3 (`pip install mitsuba`).
"""

import argparse
import json
import pathlib
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

sys.dont_write_bytecode = True  # nothing is left in the source folder
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import element_scenes  # noqa: E402
import numpy  # noqa: E402
import render_mitsuba  # noqa: E402

BANDS, BAND_COUNT, EDGE, REPLICATES = "400:700:4", 4, 16, 32
PILOT = 32  # samples per pixel and replicate that tell how many are needed
DASH = "–"
# Of public scenes: what docs/scene_format.md says of them.
KNOWN = {
    "matpreview": "small coloured lamps in a map: between texels ours are means of spectra",
    "cbox-rgb": "rgb: Mitsuba interpolates coefficients in a table, ours are exact (0.3 % of the red wall's blue)",
    "mi": "Mitsuba's ldsampler, and coefficients of rgb from a table (0.4 %); agrees with `independent` and spectra as numbers",
}


def box_film():
    film = ElementTree.Element("film", type="hdrfilm")
    ElementTree.SubElement(film, "rfilter", type="box")
    return film


def kiloband(options, *arguments):
    """(exit code, first error without its place)"""
    done = subprocess.run([options.kiloband, *map(str, arguments)], capture_output=True, text=True)
    errors = [line.split("error: ", 1)[1] for line in done.stderr.splitlines() if "error: " in line]
    return done.returncode, errors[0] if errors else done.stderr.strip()[-200:]


def scenes_below(folder):
    for file in sorted(folder.rglob("*.xml")):
        try:
            root = ElementTree.parse(file).getroot()
        except ElementTree.ParseError:
            continue
        if root.tag == "scene" and (root.find(".//sensor") is not None or root.find("include") is not None):
            yield file


def mitsuba(options, *arguments):
    """None, or why it could not be done. A process of its own: some scenes end Mitsuba."""
    script = pathlib.Path(render_mitsuba.__file__)
    command = [sys.executable, script, *map(str, arguments), "--variant", options.variant]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode == 0:
        return None
    if done.returncode < 0:
        return f"ended by signal {-done.returncode}"
    return done.stderr.strip().splitlines()[-1].split("]: ", 1)[-1][:160]


def edge_of(file):
    """Pixels: a radiancemeter has one."""
    return 1 if 'type="radiancemeter"' in file.read_text() else EDGE


def render_both(options, file, samples, turn):
    """Cubes of both programs, with other random numbers each turn; returns why it could not be done, or None."""
    edge = edge_of(file)
    size = ("--size", f"{edge}x{edge}", "--bands", BANDS, "--replicates", REPLICATES)
    seed = 2 * options.seed + turn
    why = mitsuba(options, file, *size, "--spp", samples, "--seed", seed, "-o", options.output / "cube.hdr")
    if why is not None:
        return "Mitsuba: " + why
    same = options.output / "ours.xml"
    same.write_text(render_mitsuba.adapted(file, box_film()))
    ours = ("--keep-replicates", "--quiet", "--backend", "cpu", "-o", options.output / "ours.hdr")
    code, why = kiloband(options, "render", same, *size, "--spp", samples * REPLICATES, "--seed", seed, *ours)
    return why if code else None


def means(options, stem):
    files = [options.output / f"{stem}.r{r:02d}.img" for r in range(REPLICATES)]
    return numpy.mean([numpy.fromfile(file, "<f4").reshape(BAND_COUNT, -1).mean(axis=1) for file in files], axis=0)


def compare(options, record, level):
    theirs = ",".join(str(options.output / f"cube.r{r:02d}.hdr") for r in range(REPLICATES))
    verdict = options.output / "compare.json"
    code, why = kiloband(options, "compare", options.output / "ours.hdr", theirs, "--no-variances", "--alpha", level, "--json", verdict)
    if code > 1:
        record["why"] = why
        return
    a, b = means(options, "ours"), means(options, "cube")
    result = json.loads(verdict.read_text())
    with numpy.errstate(divide="ignore", invalid="ignore"):  # nothing but black
        relative, all_channels = a / b - 1, a.sum() / b.sum() - 1
    worst = min(result["tests"], key=lambda test: test["p"] / test["level"])
    record |= {
        "agrees": result["passed"],
        "all": float(all_channels),
        "largest": float(relative[numpy.argmax(numpy.abs(relative))]),
        "detectable": result["detectable_bias"]["image"]["median"],
        "p": min(test["p"] for test in result["tests"] if test["name"] == "mean/image"),
        "worst": {"test": worst["name"], "p": worst["p"]},
    }


def examine(options, name, file, known, level):
    record = {"scene": name, "known": known, "theirs": None}
    code, why = kiloband(options, "info", file, "--bands", BANDS)
    record["ours"] = None if code == 0 else why
    if code == 0:
        record["why"] = render_both(options, file, PILOT, 0)
    if code or record["why"] is not None:
        record["theirs"] = mitsuba(options, file, "--load")
        return record
    pilot = {}
    compare(options, pilot, level)
    record["samples"] = needed_samples(options, pilot)
    record["why"] = render_both(options, file, record["samples"], 1)
    if record["why"] is None:
        compare(options, record, level)
    return record


def needed_samples(options, pilot):
    """So that the aimed bias would be seen; at most --most. What the pilot's means are has no part in it. Half more than the pilot's spread
    asks for: 32 replicates tell a spread within 12 %."""
    seen = pilot.get("detectable") or options.aim
    return max(PILOT, min(options.most, round(1.5 * PILOT * (seen / options.aim) ** 2)))


def percent(value):
    return f"{100 * value:+.2f} %" if numpy.isfinite(value) else "black in Mitsuba"


def row(record):
    said = lambda why: "loads" if why is None else "refuses"  # noqa: E731
    figures = [DASH] * 5
    remark = record["ours"] or record.get("why") or (record["theirs"] and "Mitsuba: " + record["theirs"]) or ""
    verdict = "" if record["ours"] is None else "refused"
    if "agrees" in record:
        verdict = "agrees" if record["agrees"] else "**differs**"
        detectable = f"{100 * record['detectable']:.2f} %" if record["detectable"] is not None else DASH
        figures = [percent(record["all"]), percent(record["largest"]), f"{record['p']:.2g}", detectable, str(record["samples"])]
        if not record["agrees"]:
            remark = f"{record['worst']['test']} p {record['worst']['p']:.1g}"
    if record["known"]:
        remark = record["known"] if not remark or "agrees" in record else f"{record['known']} ({remark})"
    cells = [record["scene"], said(record["ours"]), said(record["theirs"]), verdict, *figures, remark]
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"


def table(records, options, seconds, version):
    agree = [r for r in records if r.get("agrees")]
    both = [r for r in records if r["ours"] is None and r["theirs"] is None]
    lines = [
        f"{len(records)} scenes; kiloband loads {sum(r['ours'] is None for r in records)}, Mitsuba {version} {sum(r['theirs'] is None for r in records)}, "
        f"both {len(both)}, of which {len(agree)} agree, {sum(r.get('agrees') is False for r in records)} differ and "
        f"{sum('agrees' not in r for r in both)} could not be compared. 32 replicates of 16 x 16 pixels, 4 channels; samples for a detectable "
        f"bias of {100 * options.aim:g} %, at most {options.most} per pixel and replicate; rate of false alarms {options.rate:g} in all; seed {options.seed}; {seconds / 60:.0f} minutes.",
        "",
        "| scene | kiloband | Mitsuba | images | all channels | largest | p, image | detectable | samples | remark |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    return "\n".join(lines + [row(r) for r in records]) + "\n"


def list_scenes(options):
    """[(name, file, known difference or "")]"""
    scenes = []
    for folder in options.folders:
        for file in scenes_below(folder):
            name = str(file.relative_to(folder).with_suffix(""))
            scenes.append((name, file, KNOWN.get(file.stem, "")))
    if options.elements:
        folder = options.output / "elements"
        scenes += [(f"elements/{name}", folder / f"{name}.xml", known) for name, known in element_scenes.write_scenes(folder)]
    return scenes


def earlier_records(options):
    """By scene: with --only the others stay as they are."""
    file = options.output / "scenes.json"
    records = json.loads(file.read_text())["scenes"] if options.only and file.exists() else []
    return {record["scene"]: record for record in records}


def write_results(options, records, seconds, version):
    text = table(records, options, seconds, version)
    (options.output / "scenes.md").write_text(text)
    result = {"format": "kiloband against mitsuba: scenes 1", "mitsuba": version, "seconds": seconds, "scenes": records}
    (options.output / "scenes.json").write_text(json.dumps(result, indent=1) + "\n")
    print(text.splitlines()[0])


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("kiloband", type=pathlib.Path)
    parser.add_argument("folders", nargs="*", type=pathlib.Path)
    parser.add_argument("-o", dest="output", type=pathlib.Path, default=pathlib.Path("scene_results"))
    parser.add_argument("--elements", action="store_true", help="also the scenes of element_scenes.py")
    parser.add_argument("--only", nargs="+", default=[], help="scenes whose names contain one of these; rows of others stay in DIR")
    parser.add_argument("--aim", type=float, default=0.005, help="bias of the image's mean that is to be found")
    parser.add_argument("--most", type=int, default=2048, help="samples per pixel and replicate")
    parser.add_argument("--rate", type=float, default=1e-3, help="of false alarms, all scenes together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--variant", default="scalar_spectral")
    options = parser.parse_args()
    options.output = options.output.resolve()
    return options


def main():
    options = parse()
    version = render_mitsuba.find_mitsuba(options.variant).__version__
    options.output.mkdir(parents=True, exist_ok=True)
    scenes, start, done = list_scenes(options), time.monotonic(), earlier_records(options)
    for name, file, known in scenes:
        if options.only and not any(part in name for part in options.only):
            continue
        done[name] = examine(options, name, file, known, options.rate / len(scenes))
        print(row(done[name]), flush=True)
    records = [done[name] for name, _, _ in scenes if name in done]
    write_results(options, records, time.monotonic() - start, version)
    return int(any(r.get("agrees") is False and not r["known"] for r in records))


if __name__ == "__main__":
    sys.exit(render_mitsuba.exit_code(main))
