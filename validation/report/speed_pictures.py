#!/usr/bin/env python3
"""The two plots of README.md from the results of `kiloband bench`: equal-error speed against K beside other renderers, and error against time.

Usage: speed_pictures.py DIR OUT    DIR/bench.json of a full run; writes OUT/equal_error_speed.svg and OUT/error_against_time.svg
Needs matplotlib.
"""

import pathlib
import sys

sys.dont_write_bytecode = True  # nothing is left in the source folder

import speed_plots  # noqa: E402
import speed_sections  # noqa: E402
from speed_data import SpeedError, distinct, pick, ratio_label, read_bench  # noqa: E402


def equal_error_speed(records):
    shown = pick(records, case="peers", quantity="equal_error_speed")
    curves = speed_sections.by_scene(shown, "channels", ratio_label)
    return speed_plots.panels(curves, "channels K", "times sooner at equal error", reference=1)


def error_against_time(records):
    """Backends' fastest mode, and what makes them slower, of single pixels."""
    records = [r for r in pick(records, case="error", wavelengths="shared") if (r.get("replicates") or 1) in (1, 16)]
    scenes = distinct(pick(records, quantity="relative_error"), "scene")
    curves = {scene: speed_sections.error_curves(records, scene, "pixel") for scene in scenes}
    return speed_plots.panels(curves, "seconds per image", "relative error of a pixel")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    directory, out = map(pathlib.Path, sys.argv[1:])
    try:
        records = read_bench(directory / "bench.json")["records"]
        for name, picture in (("equal_error_speed", equal_error_speed(records)), ("error_against_time", error_against_time(records))):
            if not picture:
                raise SpeedError(f"{directory}: nothing of what {name}.svg shows")
            (out / f"{name}.svg").write_bytes(picture)
    except (SpeedError, OSError) as error:
        sys.exit(f"speed_pictures.py: {error}")


if __name__ == "__main__":
    main()
