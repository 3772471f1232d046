"""The Markdown tables of a run: numbers that are known, the figure nearest to its limit, missing parts."""

import json
import pathlib
import sys
import tempfile
import unittest

REPORT = pathlib.Path(__file__).resolve().parents[4] / "validation" / "report"
sys.path.insert(0, str(REPORT))

import report  # noqa: E402
import small_results  # noqa: E402
import summary  # noqa: E402


def text_of(content, *names):
    with tempfile.TemporaryDirectory() as folder:
        directory = pathlib.Path(folder)
        (directory / "results.json").write_text(json.dumps(content))
        return summary.summary(directory, names)


class Summary(unittest.TestCase):
    def test_cases_with_their_margin_and_what_they_would_see(self):
        text = text_of(small_results.results(False), "cases")
        # smallest p 0.3 at level 1e-5; a failed test has 1e-9 / 1e-5
        self.assertIn("| good | passed | 1 | 0 | 3e+04 | – | 0.2 % | – | 5 % |", text)
        self.assertIn("| wrong | FAILED | 1 | 1 | 0.0001 | – | 0.2 % | – | 5 % |", text)
        self.assertIn("2 comparisons: FAILED.", text)
        self.assertNotIn("slope", text)

    def test_hard_figures_of_all_backends_in_a_row(self):
        text = text_of(small_results.results(False), "hard")
        self.assertIn("| case | figure | reference | error, cpu | error, opencl:pt | limit | note |", text)
        self.assertIn("| grazing | total | 1 | 0.5 | 0.5 | 1e-06 | FAILED; n |", text)

    def test_nearest_to_its_limit(self):
        content = small_results.results(True)
        other = dict(content["hard_cases"][0]["figures"][0], name="other", error=0.9e-6, limit=1e-6)
        exact = dict(other, name="exact", error=0, limit=0)
        content["hard_cases"] = [
            dict(content["hard_cases"][0], figures=[dict(other, name="far", error=1e-9), other, exact])
        ]
        text = text_of(content, "nearest")
        self.assertIn("| grazing | other | 9e-07 | 1e-06 |", text)
        self.assertNotIn("far", text)
        self.assertNotIn("exact", text)
        alone = dict(other, name="alone", error=0.95e-6)
        content["hard_cases"].append(dict(content["hard_cases"][0], backend="opencl:pt", figures=[alone]))
        content["hard_cases"][0]["figures"].append(dict(other, name="of both", error=1e-9))
        content["hard_cases"][1]["figures"].append(dict(other, name="of both", error=1e-9))
        self.assertIn("| grazing | of both | 1e-09 | 1e-09 | 1e-06 |", text_of(content, "nearest"))
        lost = dict(other, name="lost", error=None, passed=False)
        content["hard_cases"][0]["figures"].append(lost)
        self.assertIn("| grazing | lost |", text_of(content, "nearest"))

    def test_convergence(self):
        text = text_of(small_results.results(True), "convergence")
        self.assertIn("| convergence/box | cpu shared sobol | -0.7 ± 0.01 | 8 | 23 % | 0.8 | 23 |", text)

    def test_a_run_that_was_interrupted_early(self):
        content = small_results.results(True, cases=[], hard_cases=[], convergence=[], interrupted=True)
        self.assertEqual(text_of(content | {"passed": False}).count("\n|---"), 5)
        self.assertIn("2 comparisons: interrupted.", text_of(content | {"passed": False}))
        failed = small_results.results(False, interrupted=True)
        failed["cases"][1]["interrupted"] = True
        self.assertIn("2 comparisons: FAILED.", text_of(failed))
        self.assertIn("| wrong | FAILED |", text_of(failed, "cases"))

    def test_no_results(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(report.ReportError):
            summary.summary(pathlib.Path(folder))


if __name__ == "__main__":
    unittest.main()
