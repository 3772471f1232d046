"""The scenes of validation/mitsuba/elements load, or are refused, as the table of validation/results says.

Usage: test_element_scenes.py KILOBAND
"""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # nothing is left in the source folder
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "validation" / "mitsuba"))

import element_scenes  # noqa: E402

PROGRAM = sys.argv.pop() if len(sys.argv) > 1 else None


def documented():
    """{"elements/NAME": "loads" or "refuses"}"""
    text = (ROOT / "validation" / "results" / "mitsuba_scenes.md").read_text()
    return dict(re.findall(r"^\| (elements/\w+) \| (loads|refuses) \|", text, re.MULTILINE))


def found(folder):
    names = [name for name, _ in element_scenes.write_scenes(folder)]
    lines = subprocess.run([PROGRAM, "info", "--bands", "400:700:4", "--check", folder], capture_output=True, text=True).stdout
    words = dict((name, word) for word, name in re.findall(r"^(loads|stopped) +(\w+)\.xml$", lines, re.MULTILINE))
    return {f"elements/{name}": {"loads": "loads", "stopped": "refuses"}[words[name]] for name in names}


class ElementScenes(unittest.TestCase):
    def test_load_as_the_table_says(self):
        self.maxDiff = None
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(found(pathlib.Path(folder)), documented())

    def test_are_many(self):
        self.assertGreater(len(documented()), 180)


if __name__ == "__main__":
    unittest.main()
