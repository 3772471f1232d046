"""validation/raysect renders the same Cornell box as we do: means of channels, where a python3 has Raysect (skips with code 77 where none has).

Usage: test_raysect.py KILOBAND
Interpreters that are tried: KILOBAND_RAYSECT_PYTHON, python3 of the path, this one.
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

sys.dont_write_bytecode = True  # nothing is left in the source folder
ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "validation" / "raysect" / "time_raysect.py"
SCENE = ROOT / "scenes" / "cornell_box" / "cornell_box.xml"
PROGRAM = sys.argv.pop() if len(sys.argv) > 1 else None

SIZE, CHANNELS, ROUNDS, SAMPLES = 16, 8, 64, 128
# Student's t of 63 degrees of freedom, two-sided, at 1e-4 / 16: false alarms of all 16 comparisons together are below 1e-4.
LIMIT = 4.94


def interpreter():
    """The first that has Raysect, or None."""
    for name in filter(None, (os.environ.get("KILOBAND_RAYSECT_PYTHON"), "python3", sys.executable)):
        try:
            if subprocess.run([name, "-B", SCRIPT, "--probe"], capture_output=True).returncode == 0:
                return name
        except OSError:
            continue
    return None


def image(header):
    """[channel][line][sample]"""
    return numpy.fromfile(header.with_suffix(".img"), "<f4").reshape(CHANNELS, SIZE, SIZE).astype(float)


def render(folder, python):
    """Ours, and Raysect's rounds."""
    common = [str(SCENE), "--bands", f"400:700:{CHANNELS}", "--size", f"{SIZE}x{SIZE}"]
    ours, theirs = folder / "ours.hdr", folder / "theirs.hdr"
    subprocess.run([PROGRAM, "render", *common, "--spp", "4096", "--seed", "1", "-o", ours], check=True, capture_output=True)
    # One process: its numbers follow from the seed. Narrow bins: see time_raysect.py.
    effort = ["--spp", str(SAMPLES), "--rounds", str(ROUNDS), "--seed", "1", "--processes", "1", "--bins-per-channel", "13"]
    effort += ["--important-path-weight", "0.6"]  # less noise in few samples
    subprocess.run([python, "-B", SCRIPT, *common, *effort, "-o", theirs], check=True, capture_output=True)
    return image(ours), numpy.stack([image(folder / f"theirs.r{r:02d}.hdr") for r in range(ROUNDS)])


class Raysect(unittest.TestCase):
    def test_renders_the_same_scene(self):
        """Means over the upper quarter, with the light, and over the rest, of each channel, against ours, whose error is a fraction of theirs.
        A difference of 2 % in the lower part is noticed with a probability above 0.9."""
        with tempfile.TemporaryDirectory() as folder:
            ours, theirs = render(pathlib.Path(folder), PYTHON)
        for name, lines in (("upper", slice(0, SIZE // 4)), ("lower", slice(SIZE // 4, SIZE))):
            expected = ours[:, lines].mean(axis=(1, 2))
            means = theirs[:, :, lines].mean(axis=(2, 3))
            error = means.std(axis=0, ddof=1) / ROUNDS**0.5
            t = (means.mean(axis=0) - expected) / error
            print(name, "difference", numpy.round(means.mean(axis=0) / expected - 1, 4), "error", numpy.round(error / expected, 4))
            self.assertLess(numpy.abs(t).max(), LIMIT, f"{name} part: t of each channel {t}")


if __name__ == "__main__":
    PYTHON = interpreter()
    if PYTHON is None:
        print("no python3 has Raysect (pip install raysect; KILOBAND_RAYSECT_PYTHON names one)")
        sys.exit(77)
    unittest.main()
