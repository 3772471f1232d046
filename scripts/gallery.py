"""Renders each scene of the gallery and draws it beside the spectrum of a marked pixel.

Usage: gallery.py BUILD_DIR OUT_DIR    (scripts/gallery.sh builds first; needs matplotlib)

Everything comes from the project's own programs: generate_scenes writes the scenes, `kiloband render` the cube and
its preview, `kiloband convert --pixel` the spectrum with its standard error.
"""
import csv
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

# name, scene file below the folder of scenes, bands, size, samples, marked pixel, further options, title
GALLERY = [
    ("cornell_box", "cornell_box/cornell_box.xml", "400:700:100", "256x256", 512, (96, 140), [],
     "cornell_box: 100 channels, the side of the tall block that faces the red wall"),
    ("conference", "conference/conference.xml", "400:700:100", "480x270", 256, (170, 100), [],
     "conference: 887,562 triangles, depth 9"),
    ("statues", "statues/statues.xml", "400:700:100", "480x270", 256, (430, 135), [],
     "statues: dispersive glass, bronze, marble, depth 17"),
    ("aircraft", "aircraft/aircraft.xml", "400:700:100", "480x270", 128, (250, 145), [],
     "aircraft, visible"),
    ("aircraft_swir", "aircraft/aircraft_swir.xml", None, "480x270", 64, (400, 112), [],
     "aircraft, 1 to 2.5 µm: the sky and sun reflected, the exhaust"),
    ("aircraft_lwir", "aircraft/aircraft_lwir.xml", None, "480x270", 64, (258, 118), [],
     "aircraft, 8 to 12 µm: by its own temperatures"),
]


def run(*command):
    print(" ".join(str(part) for part in command), flush=True)
    subprocess.run([str(part) for part in command], check=True)


def render(kiloband, scenes, work, entry):
    """Returns the preview's path and the rows of the pixel's spectrum."""
    name, scene, bands, size, samples, (x, y), options, _ = entry
    path = scenes / scene if (scenes / scene).exists() else pathlib.Path("scenes") / scene  # without meshes to generate
    cube, preview, spectrum = work / f"{name}.hdr", work / f"{name}.png", work / f"{name}.csv"
    run(kiloband, "render", path, *(["--bands", bands] if bands else []), "--size", size, "--spp", samples,
        "--variance", "--quiet", "-o", cube, "--preview", preview, *options)
    run(kiloband, "convert", cube, spectrum, "--pixel", f"{x},{y}", "--quantity", "density")
    with open(spectrum, newline="") as file:
        return preview, list(csv.DictReader(file))


def draw(entry, preview, rows, out):
    (x, y), title = entry[5], entry[7]
    centres = [0.5 * (float(r["min_nm"]) + float(r["max_nm"])) for r in rows]
    values = [float(r["value"]) for r in rows]
    errors = [float(r["standard_error"]) for r in rows]
    micrometres = centres[-1] > 2000
    axis = [c / 1000 for c in centres] if micrometres else centres
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.7), width_ratios=(1.75, 1), layout="constrained")
    left.imshow(plt.imread(preview))
    left.plot([x], [y], "o", markersize=9, markerfacecolor="none", markeredgecolor="magenta", markeredgewidth=1.6)
    left.set_axis_off()
    left.set_title(title, fontsize=10)
    right.fill_between(axis, [v - e for v, e in zip(values, errors)], [v + e for v, e in zip(values, errors)], alpha=0.3)
    right.plot(axis, values, linewidth=1.1)
    right.set_xlabel("wavelength / " + ("µm" if micrometres else "nm"))
    right.set_ylabel("spectral radiance / W m$^{-2}$ sr$^{-1}$ nm$^{-1}$")
    right.set_title("the marked pixel, ± 1 standard error", fontsize=10)
    right.set_ylim(bottom=0)
    right.grid(alpha=0.3)
    figure.savefig(out, dpi=80)
    plt.close(figure)


def main():
    build, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    wanted = sys.argv[3:]
    kiloband = build / "app/kiloband"
    scenes, work = build / "gallery/scenes", build / "gallery/cubes"
    out.mkdir(parents=True, exist_ok=True)
    work.mkdir(parents=True, exist_ok=True)
    run(build / "generate_scenes", scenes)
    run(kiloband, "sky", scenes / "aircraft/sky.exr")
    for entry in GALLERY:
        if wanted and entry[0] not in wanted:
            continue
        preview, rows = render(kiloband, scenes, work, entry)
        draw(entry, preview, rows, out / f"{entry[0]}.png")


main()
