#!/usr/bin/env python3
"""Makes DIR/report.html of what `kiloband validate -o DIR` wrote: one page that needs no other file.

Usage: report.py DIR    (needs numpy and matplotlib: apt-get install python3-matplotlib)

Reads DIR/results.json and the cubes that it names. Sections and values that are missing are left out: a run that was interrupted
has a report too.
"""

import json
import pathlib
import sys

sys.dont_write_bytecode = True  # nothing is left in the source folder

import cases  # noqa: E402
import comparisons  # noqa: E402
import markup  # noqa: E402
import studies  # noqa: E402
import verdict  # noqa: E402


class ReportError(Exception):
    """The results cannot be read; the message says why."""


def read_json(file):
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ReportError(f"{file}: {error}") from error


def read_results(directory):
    results = read_json(directory / "results.json")
    if not isinstance(results, dict) or not str(results.get("format", "")).startswith("kiloband validation"):
        raise ReportError(f"{directory / 'results.json'}: not the results of kiloband validate")
    for section in ("cases", "hard_cases", "convergence"):
        results[section] = [entry for entry in results.get(section) or [] if isinstance(entry, dict)]
    for case in results["cases"]:
        case["pairings"] = [p for p in case.get("pairings") or [] if isinstance(p, dict)]
    results["mitsuba"] = read_mitsuba(results.get("mitsuba"))
    return results


def read_mitsuba(section):
    record = section if isinstance(section, dict) else {}
    return record | {"scenes": [scene for scene in record.get("scenes") or [] if isinstance(scene, dict)]}


def navigation(sections):
    names = {
        "failures": "Failures",
        "verdicts": "Verdicts",
        "cases": "Cases",
        "tails": "Tails",
        "hard": "Hard cases",
        "convergence": "Convergence",
        "mitsuba": "Against Mitsuba 3",
    }
    links = [f'<a href="#{anchor}">{name}</a>' for anchor, name in names.items() if f'<h2 id="{anchor}"' in sections]
    return f"<nav>{''.join(links)}</nav>"


def report_html(directory):
    results = read_results(directory)
    anchors = {id(case): f"case-{k}" for k, case in enumerate(results["cases"])}
    sections = "\n".join(
        [
            verdict.failures(results),
            verdict.limits(results),
            comparisons.overview(results, anchors),
            cases.cases(results, anchors, directory),
            cases.tails_overview(results),
            studies.hard_cases(results),
            studies.convergence(results),
            studies.mitsuba(results),
        ]
    )
    return markup.page("Validation of kiloband", verdict.head(results) + navigation(sections) + sections)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    directory = pathlib.Path(sys.argv[1])
    try:
        html = report_html(directory)
        (directory / "report.html").write_text(html, encoding="utf-8")
    except (ReportError, OSError) as error:
        sys.exit(f"report.py: {error}")


if __name__ == "__main__":
    main()
