"""The comparison with Mitsuba 3, as far as it needs no Mitsuba: statistics and the adapted scene."""

import math
import pathlib
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[4]
sys.path[:0] = [str(ROOT / "validation" / "mitsuba"), str(ROOT / "validation" / "report")]

import cubes  # noqa: E402
import render_mitsuba  # noqa: E402
import welch  # noqa: E402


class Statistics(unittest.TestCase):
    def test_student_p(self):
        # Tables of Student's t; dof 1 is Cauchy's law: 1 - 2 atan(t) / pi; dof 2: 1 - t / sqrt(2 + t^2).
        self.assertAlmostEqual(welch.student_p(12.7062, 1), 0.05, places=6)
        self.assertAlmostEqual(welch.student_p(3.0, 2), 1 - 3 / 11**0.5, places=12)
        self.assertAlmostEqual(welch.student_p(2.04227, 30), 0.05, places=6)
        self.assertAlmostEqual(welch.student_p(0.0, 7.5), 1, places=12)

    def test_quantile_inverts(self):
        for p in (1e-9, 1e-3, 0.2):
            for dof in (3, 31.7, 62):
                self.assertAlmostEqual(welch.student_p(welch.student_quantile(p, dof), dof) / p, 1, places=8)

    def test_welch_by_hand(self):
        # Variances 1 and 4/3 of 3 and 4 replicates: both means have the variance 1/3.
        ours, theirs = numpy.array([[1.0], [2], [3]]), numpy.array([[3.0], [5], [3], [5]])
        result = welch.compare(ours, theirs, 0.05)
        self.assertAlmostEqual(result["t"][0], -2 / (2 / 3) ** 0.5)
        self.assertAlmostEqual(result["dof"][0], (2 / 3) ** 2 / ((1 / 9) / 2 + (1 / 9) / 3))
        self.assertAlmostEqual(result["p"], welch.student_p(6**0.5, 4.8), places=9)
        self.assertAlmostEqual(result["largest_difference"], -0.5)
        self.assertTrue(result["passed"])

    def test_false_alarms(self):
        """1000 comparisons at 0.05: 21 to 84 failures with probability 1 - 1e-5 (8 independent channels, binomial)."""
        random = numpy.random.default_rng(5)
        failed = 0
        for _ in range(1000):
            _, _, _, t, dof = welch.differences(random.normal(100, 1, (32, 8)), random.normal(100, 2, (32, 8)))
            failed += welch.sidak_p([welch.student_p(abs(v), d) for v, d in zip(t, dof)]) < 0.05
        self.assertTrue(21 <= failed <= 84, failed)

    def test_detectable_bias(self):
        """A shift of one channel by its detectable size is found with probability 0.9: in 74 or more of 100, 1 - 1e-5."""
        random = numpy.random.default_rng(6)
        found = 0
        for _ in range(100):
            ours, theirs = random.normal(100, 1, (32, 3)), random.normal(100, 1, (32, 3))
            shift = 100 * welch.compare(ours, theirs, 0.05)["detectable"]["typical"]
            found += not welch.compare(ours + [0, shift, 0], theirs, 0.05)["passed"]
        self.assertTrue(74 <= found < 100, found)

    def test_not_finite_fails(self):
        """One replicate of one channel suffices, whatever the others say."""
        random = numpy.random.default_rng(7)
        ours, theirs = random.normal(100, 1, (32, 3)), random.normal(100, 1, (32, 3))
        self.assertTrue(welch.compare(ours, theirs, 1e-3)["passed"])
        for value in (math.nan, math.inf):
            for side in (0, 1):
                pair = [ours.copy(), theirs.copy()]
                pair[side][5, 1] = value
                result = welch.compare(*pair, 1e-3)
                self.assertEqual(result["p"], 0)
                self.assertFalse(result["passed"])

    def test_channels_without_error(self):
        """A channel that does not vary is equal or not; the others are tested all the same."""
        random = numpy.random.default_rng(8)
        black = numpy.zeros((32, 1))
        ours, theirs = (numpy.hstack([black, random.normal(100, 1, (32, 2))]) for _ in range(2))
        same = welch.compare(ours, theirs, 1e-3)
        self.assertTrue(0 < same["p"] < 1 and same["passed"], same)
        relative = numpy.divide(same["ours"][1:], same["theirs"][1:]) - 1
        self.assertEqual(same["largest_difference_channel"], int(numpy.argmax(abs(relative))) + 1)
        self.assertTrue(0 < same["detectable"]["typical"] <= same["detectable"]["largest"] < 0.1, same["detectable"])
        self.assertFalse(welch.compare(ours, 1.5 * theirs, 1e-3)["passed"])
        self.assertEqual(welch.compare(ours + [0.001, 0, 0], theirs, 1e-3)["p"], 0)
        both = welch.compare(numpy.zeros((4, 2)), numpy.zeros((4, 2)), 1e-3)
        self.assertEqual((both["p"], both["passed"]), (1, True))

    def test_sidak(self):
        self.assertAlmostEqual(1 - (1 - welch.sidak(0.05, 7)) ** 7, 0.05, places=14)


class Scene(unittest.TestCase):
    def test_bands(self):
        self.assertEqual(render_mitsuba.parse_bands("400:700:3"), [(400, 500), (500, 600), (600, 700)])
        self.assertEqual(render_mitsuba.parse_bands("400-410, 500-520.5"), [(400, 410), (500, 520.5)])

    def test_film_and_file_names(self):
        scene = ROOT / "scenes/cornell_box/cornell_box.xml"
        root = ElementTree.fromstring(render_mitsuba.adapted(scene, (6, 4), [(400.0, 500.0), (600.0, 700.0)]))
        (film,) = root.iter("film")
        self.assertEqual(film.get("type"), "specfilm")
        self.assertEqual([e.get("value") for e in film.findall("integer")], ["6", "4"])
        bands = [(e.get("name"), e.get("value")) for e in film.findall("spectrum")]
        self.assertEqual(
            bands,
            [("channel00000", "400.0:1, 500.0:1"), ("channel00001", "600.0:1, 700.0:1"), ("whole", "400.0:1, 700.0:1")],
        )
        files = [e.get("filename") or e.get("value") for e in root.iter() if "filename" in (*e.attrib, e.get("name"))]
        self.assertEqual(len(files), 12)
        for file in files:
            self.assertTrue(pathlib.Path(file).is_absolute() and pathlib.Path(file).is_file(), file)

    def test_scenes_have_box_filters(self):
        """Other filters treat the image's border differently in the two programs."""
        scenes = sorted((ROOT / "validation/mitsuba/scenes").glob("*.xml"))
        self.assertEqual(len(scenes), 7)
        for scene in scenes:
            self.assertEqual([f.get("type") for f in ElementTree.parse(scene).iter("rfilter")], ["box"], scene)

    def test_cube(self):
        image = numpy.arange(24, dtype=numpy.float32).reshape(2, 4, 3)
        with tempfile.TemporaryDirectory() as folder:
            header = pathlib.Path(folder) / "a.r00.hdr"
            render_mitsuba.write_cube(header, image, [(400.0, 500.0), (500.0, 600.0), (600.0, 650.5)])
            numpy.testing.assert_array_equal(cubes.read_cube(header), image)
            self.assertIn("kiloband band maximum = {500, 600, 650.5}\n", header.read_text())
            self.assertIn("kiloband quantity = integral\n", header.read_text())


if __name__ == "__main__":
    unittest.main()
