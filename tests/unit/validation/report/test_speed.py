"""The page of `kiloband bench`: figures, numbers, commands, escaping, missing parts."""

import copy
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

REPORT = pathlib.Path(__file__).resolve().parents[4] / "validation" / "report"
sys.path.insert(0, str(REPORT))

import speed_data  # noqa: E402
import speed_pictures  # noqa: E402
import speed_plots  # noqa: E402
import speed_report  # noqa: E402


def record(case, quantity, value, **fields):
    own = {"case": case, "scene": "box<1>", "backend": "cpu", "quantity": quantity, "value": value, "error": 0.1}
    return own | {"repetitions": 3, "error_kind": "half range", "command": "kiloband render a&b.xml"} | fields


def small_results():
    records = []
    for k, pt, batch in ((8, 2e6, 2.5e6), (64, 1e6, 2.25e6)):
        records.append(record("channels", "paths_per_second", pt, backend="opencl", method="pt", channels=k))
        records.append(record("channels", "paths_per_second", batch, backend="opencl", method="dpept-batch", channels=k))
        records.append(record("channels", "speed_up_over_pt", batch / pt, backend="opencl", method="dpept-batch", channels=k))
    for samples in (16, 64):
        way = {"wavelengths": "shared", "sampler": "sobol", "samples": samples, "replicates": 1}
        records.append(record("error", "seconds", samples / 100, **way))
        records.append(record("error", "relative_error", 0.8 / samples, series="pixel", **way))
        records.append(record("error", "efficiency", samples * 2, series="pixel", **way))
    missing = {"backend": "mitsuba", "method": "llvm_ad_spectral", "note": "not measured: <no module>", "scene": None}
    records.append(record("peers", "paths_per_second", None, **missing))
    machine = {"processor": "Some <CPU>", "threads": 2, "isa": "avx2", "version": "kiloband 9.8.7", "date": "2025-02-03"}
    case = {"complete": True, "failure": None, "load_before": 0.25}
    names = [case | {"name": name, "command": f"kiloband bench {name} --quick --seed 4 -o DIR"} for name in ("channels", "error", "peers")]
    return {
        "format": "kiloband bench 1",
        "machine": machine | {"opencl": None, "commit": "abc", "memory_bytes": 2**33, "load_average": 0.5},
        "quick": True,
        "seed": 4,
        "seconds": 61.0,
        "interrupted": False,
        "cases": names,
        "records": records,
    }


def page_of(results):
    with tempfile.TemporaryDirectory() as folder:
        directory = pathlib.Path(folder)
        (directory / "bench.json").write_text(json.dumps(results), encoding="utf-8")
        return speed_report.report_html(directory)


def plain(html):
    return re.sub(r"<[^>]*>", "", html)


class Page(unittest.TestCase):
    def test_figures_numbers_and_commands(self):
        page = page_of(small_results())
        self.assertEqual(page.count('<figure class="wide">'), 4)  # paths, speed-up, error of pixels, efficiency
        for part in (
            "Repeats it: kiloband bench channels --quick --seed 4 -o DIR",
            "Load average before it: 0.25.",
            "4 numbers and their commands",
            "kiloband render a&amp;b.xml",
            "2.25",
            "Some &lt;CPU&gt;, 2 threads, avx2",
            "kiloband 9.8.7, commit abc",
            "8.0 GiB",
            "no device",
            "± is the half range",
            "Mitsuba llvm_ad_spectral: not measured: &lt;no module&gt;",
            "A quick run",
        ):
            self.assertIn(part, plain(page))
        self.assertNotIn("<CPU>", page)
        self.assertNotIn("box<1>", page)

    def test_only_what_was_measured(self):
        results = small_results()
        results["records"] = speed_data.pick(results["records"], case="channels")
        results["quick"] = False
        page = page_of(results)
        self.assertIn('<h2 id="channels">', page)
        self.assertNotIn('<h2 id="error">', page)
        self.assertNotIn("A quick run", page)

    def test_failures_and_interruptions_are_told(self):
        results = small_results()
        results["cases"][1]["failure"] = "the <device> was lost"
        results["interrupted"] = True
        page = page_of(results)
        self.assertIn('<div class="failure">the &lt;device&gt; was lost</div>', page)
        self.assertIn("Interrupted", page)

    def test_tuned_sizes_are_told(self):
        results = small_results()
        device = {"name": "GPU <7>", "platform": "Some", "driver": "1.2", "tuned": []}
        results["machine"]["opencl"] = device
        self.assertIn("GPU &lt;7&gt; (Some, 1.2)", page_of(results))
        self.assertNotIn("tuned", page_of(results))
        device["tuned"] = [{"method": "pt", "channels": 64, "sizes": "paths in flight 4096"}]
        self.assertIn("GPU &lt;7&gt; (Some, 1.2), tuned (pt at 64 channels: paths in flight 4096)", page_of(results))

    def test_peers_without_variants_and_scenes_that_they_refuse(self):
        results = small_results()
        raysect = {"backend": "raysect", "channels": 8}
        results["records"] += [
            record("peers", "paths_per_second", 6e4, scene="box", **raysect),
            record("peers", "equal_error_speed", 70.0, scene="box", channels=8, sampler="sobol", series="raysect"),
            record("peers", "paths_per_second", None, scene="glass", backend="raysect", note="not measured: emitter <sky>"),
        ]
        page = page_of(results)
        self.assertIn("Raysect, glass: not measured: emitter &lt;sky&gt;", plain(page))
        self.assertEqual(page.count('<figure class="wide">'), 6)  # two of peers

    def test_an_empty_run_has_a_page(self):
        page = page_of({"format": "kiloband bench 1"})
        self.assertIn("Speed of kiloband", page)
        self.assertNotIn("<figure", page)

    def test_no_page_of_something_else(self):
        with tempfile.TemporaryDirectory() as folder:
            for text in ("{", '{"format": "kiloband validation 1"}', "[]"):
                (pathlib.Path(folder) / "bench.json").write_text(text)
                end = subprocess.run([sys.executable, REPORT / "speed_report.py", folder], capture_output=True, text=True)
                self.assertEqual(end.returncode, 1)
                self.assertTrue(end.stderr.startswith("speed_report.py: "), end.stderr)
                self.assertFalse((pathlib.Path(folder) / "report.html").exists())


class Pictures(unittest.TestCase):
    """The plots of the README."""

    def write(self, results, out):
        directory = pathlib.Path(out)
        (directory / "bench.json").write_text(json.dumps(results), encoding="utf-8")
        command = [sys.executable, str(REPORT / "speed_pictures.py"), out, out]
        return subprocess.run(command, capture_output=True, text=True)

    def test_both_show_what_was_measured(self):
        results = small_results()
        for k in (8, 31):
            fields = {"series": "mitsuba llvm_ad_spectral", "sampler": "sobol", "channels": k}
            results["records"].append(record("peers", "equal_error_speed", 20.0 * k, **fields))
        with tempfile.TemporaryDirectory() as folder:
            done = self.write(results, folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            for name, text in (("equal_error_speed", "times sooner"), ("error_against_time", "seconds per image")):
                self.assertIn(text, (pathlib.Path(folder) / f"{name}.svg").read_text(encoding="utf-8"))

    def test_a_run_without_peers_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            done = self.write(small_results(), folder)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("nothing of what equal_error_speed.svg shows", done.stderr)


class Curves(unittest.TestCase):
    def test_error_against_time_joins_records(self):
        from speed_sections import error_curves

        curves = error_curves(small_results()["records"], "box<1>", "pixel")
        self.assertEqual(curves, {"CPU shared sobol": [(0.16, 0.05, 0.1), (0.64, 0.0125, 0.1)]})

    def test_small_kernels_are_added_up(self):
        from speed_sections import stage_lines

        found = {"channels": 8, "error": None}
        kernels = {"pt_update": 5.0, "film_clear": 1.0, "compact": 0.25, "shade": 7.0}
        records = [record("stages", "time_per_path", value, series=name) | found for name, value in kernels.items()]
        expected = {"evaluation": [(8, 5.0, 0.0)], "shade": [(8, 7.0, 0.0)], "small kernels": [(8, 1.25, 0.0)]}
        self.assertEqual(stage_lines(records), expected)

    def test_numbers_that_are_missing_are_left_out(self):
        records = copy.deepcopy(small_results()["records"])
        records[0]["value"] = None
        found = speed_data.lines(speed_data.pick(records, quantity="paths_per_second"), "channels", speed_data.way_label)
        self.assertEqual(found["OpenCL pt"], [(64, 1e6, 0.1)])

    def test_ratios_have_the_colour_of_what_they_are_over(self):
        labels = [speed_data.ratio_label({"sampler": "sobol", "series": series}) for series in ("mitsuba llvm_ad_spectral", "raysect")]
        self.assertEqual(labels, ["CPU sobol : Mitsuba llvm_ad_spectral", "CPU sobol : Raysect"])
        colours = [speed_plots.style_of(label, 0)["color"] for label in labels]
        self.assertEqual(colours, [speed_plots.COLOURS["Mitsuba"], speed_plots.COLOURS["Raysect"]])

    def test_ticks(self):
        self.assertEqual(speed_plots.tick_text(300.0), "300")
        self.assertEqual(speed_plots.tick_text(0.002), "0.002")
        self.assertEqual(speed_plots.tick_text(1e6), "$10^{6}$")
        self.assertEqual(speed_plots.tick_text(1.5e-5), r"$1.5\cdot10^{-5}$")


if __name__ == "__main__":
    unittest.main()
