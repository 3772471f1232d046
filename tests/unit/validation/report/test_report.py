"""The report of validation results: verdicts, embedded pictures, escaping, missing parts."""

import base64
import functools
import io
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
import numpy

REPORT = pathlib.Path(__file__).resolve().parents[4] / "validation" / "report"
sys.path.insert(0, str(REPORT))

import cubes  # noqa: E402
import markup  # noqa: E402
import report  # noqa: E402
import small_results  # noqa: E402


def page_of(content, extra=()):
    """The page of a run; extra: (file, text) pairs beside results.json."""
    with tempfile.TemporaryDirectory() as folder:
        directory = pathlib.Path(folder)
        small_results.write_run(directory, content)
        for name, text in extra:
            (directory / name).write_text(text)
        return report.report_html(directory)


@functools.lru_cache
def page_of_run(passed):
    return page_of(small_results.results(passed))


def plain(html):
    return re.sub(r"<[^>]*>", "", html)


class Verdicts(unittest.TestCase):
    def test_failure_comes_first_and_says_where(self):
        page = page_of_run(False)
        self.assertIn(
            '<div class="verdict bad"><b>FAILED</b> 1 case, 1 hard case failed; 2 of 2 comparisons in 2 cases, '
            "2 figures of 2 hard cases, 1 convergence study.",
            page,
        )
        self.assertIn(
            "wrong: cpu shared sobol against opencl:pt shared sobol: means of 8×8 tiles: p 10−9, level 10−5; at pixels "
            "8–15, 0–7, channel 1 (500–600 nm): A 2, B 1.9, difference 0.1 (5 %) = 10 standard errors",
            plain(page),
        )
        self.assertIn("hard case grazing on opencl:pt: total: 1.5 1 instead of 1, error 0.5, limit 10−6", plain(page))
        self.assertLess(page.index("FAILED</span> wrong"), page.index("passed</span> good"))
        self.assertLess(page.index(">wrong</a>"), page.index(">good</a>"))

    def test_pass(self):
        page = page_of_run(True)
        self.assertIn('<div class="verdict good"><b>Passed</b> 2 of 2 comparisons', page)
        self.assertNotIn("FAILED", page)
        self.assertNotIn('id="failures"', page)

    def test_head_and_limits(self):
        page = plain(page_of_run(True))
        for part in (
            "kiloband 9.8.7",
            "Some &lt;CPU&gt;",
            "2025-02-03",
            "quick, 61 s, seed 1",
            "opencl:pt on Device",
            "a run without faults fails with probability 0.0001 at most",
            "What a pass does not tell",
        ):
            self.assertIn(part, page)
        alone = small_results.results(passed=True, backends=["cpu"])
        self.assertIn("Only one backend took part: nothing was compared between backends.", plain(page_of(alone)))

    def test_rows_state_what_would_have_been_seen(self):
        page = page_of_run(True)
        self.assertRegex(
            page,
            r"32 × 64</td><td class=n>1</td><td class=n>0.3</td><td class=n>10<sup>−5</sup></td>"
            r"<td>mean/image</td><td class=n>0.2 %</td><td class=n>5 %</td>",
        )

    def test_interrupted(self):
        content = small_results.results(True, interrupted=True, comparisons=9) | {"passed": False}
        content["cases"][1]["interrupted"] = True
        page = page_of(content)
        self.assertIn("<b>Interrupted</b> nothing failed until then; 2 of 9 comparisons", page)
        self.assertIn('<span class="word open">stopped</span> wrong</h3>', page)
        self.assertNotIn("FAILED", page)


class Page(unittest.TestCase):
    def test_needs_no_other_file(self):
        page = page_of_run(False)
        sources = re.findall(r'src="([^"]*)"', page)
        self.assertGreater(len(sources), 6)
        for source in sources:
            self.assertRegex(source, r"^data:image/(png|svg\+xml);base64,")
        self.assertEqual([link for link in re.findall(r'href="([^"]*)"', page) if not link.startswith("#")], [])
        for word in ("<script", "<link", "<iframe", "@import", "url(", "http"):
            self.assertNotIn(word, re.sub(r"data:image/[^\"]*", "", page))

    def test_every_link_has_its_target(self):
        page = page_of_run(False)
        for anchor in re.findall(r'href="#([^"]*)"', page):
            self.assertIn(f'id="{anchor}"', page)

    def test_pictures_decode(self):
        page = page_of_run(True)
        shapes = [
            matplotlib.image.imread(io.BytesIO(base64.b64decode(data))).shape[:2]
            for data in re.findall(r"data:image/png;base64,([^\"]*)", page)
        ]
        self.assertEqual(shapes.count((8, 16)), 3)  # the cube of one case, z-maps of pixels of both
        self.assertEqual(shapes.count((1, 2)), 2)  # z-maps of tiles
        drawings = re.findall(r"data:image/svg\+xml;base64,([^\"]*)", page)
        self.assertEqual(len(drawings), 3)  # both cases and convergence
        for data in drawings:
            self.assertIn(b"</svg>", base64.b64decode(data))

    def test_names_are_escaped(self):
        name = '<script>alert("x")</script> & co'
        content = small_results.results(passed=True)
        content["cases"][0]["name"] = content["cases"][0]["pairings"][0]["b"] = content["hard_cases"][0]["name"] = name
        content["cases"][0]["cubes"][0]["side"] = content["convergence"][0]["curves"][0]["configuration"] = name
        page = page_of(content)
        self.assertNotIn("<script", page)
        self.assertIn("&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt; &amp; co", page)

    def test_mitsuba_section(self):
        scene = {
            "name": "box",
            "passed": False,
            "channels_nm": small_results.CHANNELS,
            "ours": [1, 2, 3],
            "theirs": [1, 2, 3.1],
            "error": [0.01] * 3,
            "p": 1e-7,
            "largest_difference": 0.033,
            "replicates": 16,
        }
        page = page_of(small_results.results(passed=True, mitsuba={"mitsuba": "3.1", "scenes": [scene]}))
        self.assertIn("Against Mitsuba 3</h2>", page)
        self.assertIn("<b>FAILED</b> 1 scene against Mitsuba failed; 2 of 2 comparisons", page)
        self.assertIn("<b>box</b> against Mitsuba: channel means p 10<sup>−7</sup>", page)
        self.assertRegex(page, r"FAILED</span></td><td>box</td>.*3.3 %")

    def test_mitsuba_on_two_backends(self):
        record = {"mitsuba": "3.1", "variant": "scalar_spectral", "python": "3.11.2", "numpy": "1.24.2", "date": "2025-02-03"}
        spectra = {"channels_nm": small_results.CHANNELS, "ours": [1, 2, 3], "theirs": [1, 2, 3], "error": [0.1] * 3}
        scenes = [
            {"name": "box", "backend": "cpu", "passed": True, "p": 0.5, "largest_difference": 0.001, "what": "a box"} | spectra,
            {"name": "box", "backend": "opencl:pt", "passed": False, "failure": "exit code 2: no <device>"},
        ]
        content = small_results.results(passed=False, mitsuba=record | {"scenes": scenes})
        content["cases"], content["hard_cases"] = content["cases"][:1], content["hard_cases"][:1]
        page = page_of(content)
        self.assertIn("<b>FAILED</b> 1 scene against Mitsuba failed; 1 of 2 comparisons in 1 case", page)
        self.assertIn("2 scenes against Mitsuba.", page)
        self.assertIn("Mitsuba 3.1 (scalar_spectral, Python 3.11.2, numpy 1.24.2)", page)
        self.assertIn("<b>box</b> on opencl:pt against Mitsuba: exit code 2: no &lt;device&gt;", page)
        self.assertEqual(page.count("no &lt;device&gt;"), 2)  # among the failures, in the table
        self.assertIn("passed</span></td><td>box</td><td>cpu</td><td>a box</td>", page)
        self.assertRegex(page, r"passed</span> box on cpu</h3>.*svg")
        self.assertNotRegex(page, r"box on opencl:pt</h3>")


class MissingParts(unittest.TestCase):
    def test_nothing_at_all(self):
        self.assertIn("Nothing was compared", page_of({"format": "kiloband validation 1"}))

    def test_null_and_absent_values(self):
        content = small_results.results(passed=True)
        pairing = content["cases"][0]["pairings"][0]
        pairing.update(tests=None, p_values=None, means=None, tails_a=None, image_a=None)
        content["cases"][1] = {
            "name": "never run",
            "passed": False,
            "error": "a < b",
            "channels_nm": None,
            "cubes": None,
        }
        content["hard_cases"] = [{"name": None, "figures": None, "error": "gone", "passed": False}, None]
        content["convergence"] = [
            {"name": "c", "passed": True, "curves": [{"configuration": "cpu", "points": None, "slope": None}]}
        ]
        page = page_of(content | {"rate": None, "seconds": None, "processor": None})
        self.assertIn("<b>never run</b> was not run: a &lt; b", page)
        self.assertIn("gone", page)

    def test_constant_images(self):
        content = small_results.results(passed=True)
        for case in content["cases"]:
            case["pairings"][0].update(image_a=[0, 0, 0], image_b=[0, 0, 0], image_error=[0, 0, 0])
        self.assertIn("Passed", page_of(content))

    def test_lost_cube_is_named(self):
        self.assertIn("no image: lost.hdr: No such file or directory", page_of_run(True))

    def test_not_results(self):
        for text, message in (("{", "Expecting property name"), ("{}", "not the results of kiloband validate")):
            with tempfile.TemporaryDirectory() as folder:
                (pathlib.Path(folder) / "results.json").write_text(text)
                done = subprocess.run(
                    [sys.executable, "-B", REPORT / "report.py", folder], capture_output=True, text=True
                )
                self.assertEqual(done.returncode, 1)
                self.assertRegex(done.stderr, rf"^report.py: {re.escape(folder)}/results.json: {message}")


class Cubes(unittest.TestCase):
    def test_interleaves(self):
        values = numpy.random.default_rng(1).random((4, 5, 3)).astype(numpy.float32)
        with tempfile.TemporaryDirectory() as folder:
            for interleave in ("bsq", "bil", "bip"):
                header = pathlib.Path(folder) / f"{interleave}.hdr"
                small_results.write_cube(header, values, interleave)
                numpy.testing.assert_array_equal(cubes.read_cube(header), values)
            (pathlib.Path(folder) / "bip.img").write_bytes(b"1234")
            with self.assertRaisesRegex(cubes.CubeError, r"^bip.hdr: 1 values instead of 4 x 5 x 3$"):
                cubes.read_cube(pathlib.Path(folder) / "bip.hdr")

    def test_equal_energy_is_neutral_and_red_is_red(self):
        channels = [[400 + 10 * k, 410 + 10 * k] for k in range(30)]
        white = cubes.colours(numpy.ones((2, 2, 30)), channels)[0, 0].astype(int)
        self.assertLess(white.max() - white.min(), 10)
        red = cubes.colours(numpy.array([[[float(c[0] >= 600) for c in channels]]]), channels)[0, 0]
        self.assertGreater(red[0], 2 * red[1:].max())

    def test_thirds_outside_the_visible(self):
        channels = [[3000, 4000], [2000, 3000], [1000, 2000]]
        cube = numpy.array([[[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]])
        numpy.testing.assert_array_equal(cubes.colours(cube, channels)[0], 255 * numpy.eye(3))


class Numbers(unittest.TestCase):
    def test_number(self):
        for value, shown in (
            (None, "–"),
            (float("nan"), "–"),
            (0.25, "0.25"),
            (-2, "−2"),
            (1e-7, "10<sup>−7</sup>"),
            (3.2e12, "3.2·10<sup>12</sup>"),
            (True, "–"),
        ):
            self.assertEqual(markup.number(value), shown)
        self.assertEqual(markup.percent(0.0123), "1.2 %")
        self.assertEqual(markup.probability(0.0), "&lt; 10<sup>−300</sup>")


if __name__ == "__main__":
    unittest.main()
