#!/usr/bin/env python3
"""Prints what `kiloband validate -o DIR` found as Markdown: the tables of validation/results.

Usage: summary.py DIR [cases|hard|nearest|convergence|mitsuba]...     (all sections without names)

cases: per case the smallest p of its comparisons over the level of its test (below 1 a test fails) and the biases that would
have been seen. hard: every figure of the hard cases. nearest: of each hard case the figure that comes nearest to its limit.
convergence: slopes, and what a second buys. mitsuba: channel means against Mitsuba 3.
"""

import pathlib
import sys

sys.dont_write_bytecode = True  # nothing is left in the source folder

from comparisons import VARIANCES, detectable  # noqa: E402
from markup import DASH, is_number  # noqa: E402
from report import ReportError, read_results  # noqa: E402
from verdict import failed_parts  # noqa: E402

def number(value, digits=2):
    return f"{value:.{digits}g}" if is_number(value) else DASH


def percent(value):
    return f"{100 * value:.2g} %" if is_number(value) else DASH


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in cells) + " |" for cells in rows]) + "\n"


def word(passed, interrupted=False):
    """A part that has failed has failed, whether it was interrupted afterwards or not."""
    if not passed:
        return "FAILED"
    return "interrupted" if interrupted else "passed"


def margin(pairing):
    """Smallest p over the level of its test."""
    ratios = [
        t["p"] / t["level"]
        for t in pairing.get("tests") or []
        if is_number(t.get("p")) and is_number(t.get("level")) and t["level"] > 0
    ]
    return min(ratios, default=None)


def _smallest(values):
    return min((v for v in values if is_number(v)), default=None)


def _case_row(case):
    pairings = case.get("pairings") or []
    of_kind = {kind: [p for p in pairings if p.get("kind") == kind] for kind in ("independent", "paired", "closed form")}
    means = [
        _smallest(detectable(p, {"mean/image"}) for p in of_kind[kind]) for kind in ("closed form", "independent", "paired")
    ]
    return [
        case.get("name"),
        word(case.get("passed"), case.get("interrupted")),
        len(pairings),
        sum((p.get("attempts") or 0) > 1 for p in pairings),
        number(_smallest(margin(p) for p in pairings)),
        *(percent(value) for value in means),
        percent(_smallest(detectable(p, VARIANCES) for p in pairings)),
    ]


def cases(results):
    heads = ["case", "", "comparisons", "repeated", "p / level", "bias: closed form", "independent", "equal seeds", "variance"]
    return table(heads, [_case_row(case) for case in results["cases"]])


def _figures(results):
    """{(case, figure): {backend: figure}}, in order."""
    figures = {}
    for hard in results["hard_cases"]:
        for figure in hard.get("figures") or []:
            figures.setdefault((hard.get("name"), figure.get("name")), {})[hard.get("backend")] = figure
    return figures


def _hard_backends(results):
    return list(dict.fromkeys(hard.get("backend") for hard in results["hard_cases"]))


def _error_heads(backends):
    return [*(f"error, {b}" for b in backends), "limit"]


def _errors(found, backends):
    """Cells of a figure: the error on each backend, the largest limit."""
    limit = max((f["limit"] for f in found.values() if is_number(f.get("limit"))), default=None)
    return [*(number((found.get(b) or {}).get("error")) for b in backends), number(limit)]


def _hard_row(key, found, backends):
    first = next(iter(found.values()))
    failed = "" if all(f.get("passed") for f in found.values()) else "FAILED; "
    note = failed + (first.get("note") or "")
    return [*key, number(first.get("reference"), 9), *_errors(found, backends), note]


def hard(results):
    backends = _hard_backends(results)
    rows = [_hard_row(key, found, backends) for key, found in _figures(results).items()]
    return table(["case", "figure", "reference", *_error_heads(backends), "note"], rows)


def _share(figure):
    """Error over limit; exact figures (limit 0) and errors that are no number are near only where they fail."""
    if is_number(figure.get("error")) and figure.get("limit"):
        return figure["error"] / figure["limit"]
    return float(not figure.get("passed")) * 1e300


def _nearness(found):
    """Failures first, exact figures last; figures of every backend before those of some; the largest error over its limit."""
    share = max(map(_share, found.values()))
    return share > 1, share > 0, len(found), share


def nearest(results):
    backends = _hard_backends(results)
    chosen = {}
    for key, found in _figures(results).items():
        if key[0] not in chosen or _nearness(found) > _nearness(chosen[key[0]][1]):
            chosen[key[0]] = (key, found)
    rows = [[*key, *_errors(found, backends)] for key, found in chosen.values()]
    return table(["case", "figure", *_error_heads(backends)], rows)


def convergence(results):
    rows = []
    for study in results["convergence"]:
        for curve in study.get("curves") or []:
            last = (curve.get("points") or [{}])[-1]
            rows.append(
                [
                    study.get("name"),
                    curve.get("configuration"),
                    f"{number(curve.get('slope'), 3)} ± {number(curve.get('slope_error'), 1)}",
                    last.get("samples", DASH),
                    percent(last.get("relative_error")),
                    number(last.get("seconds"), 3),
                    number(last.get("efficiency"), 3),
                ]
            )
    return table(["study", "configuration", "slope", "samples", "error", "seconds", "1 / (error² · s)"], rows)


def _mitsuba_row(scene):
    seen = scene.get("detectable") or {}
    return [
        scene.get("name"),
        scene.get("backend"),
        "passed" if scene.get("passed") else "FAILED",
        f"{scene.get('samples_ours', DASH)} / {scene.get('samples_theirs', DASH)}",
        percent(scene.get("difference_all")),
        percent(scene.get("largest_difference")),
        number(scene.get("p")),
        f"{percent(seen.get('typical'))} ({percent(seen.get('largest'))})",
    ]


def mitsuba(results):
    heads = ["scene", "backend", "", "samples, ours / theirs", "difference", "largest of a channel", "p", "detectable (worst)"]
    return table(heads, [_mitsuba_row(scene) for scene in results["mitsuba"]["scenes"]])


def head(results):
    interrupted = bool(results.get("interrupted"))  # such a run has not passed, nor failed by that
    verdict = word((results.get("passed") or interrupted) and not failed_parts(results), interrupted)
    backends = ", ".join(str(b) for b in results.get("backends") or [])
    return (
        f"{results.get('program')}, {results.get('date')}, {results.get('processor')}; {backends}; effort "
        f"{results.get('effort')}, seed {results.get('seed')}, {number(results.get('seconds'), 4)} s, "
        f"{results.get('comparisons')} comparisons: {verdict}.\n"
    )


SECTIONS = {"cases": cases, "hard": hard, "nearest": nearest, "convergence": convergence, "mitsuba": mitsuba}


def summary(directory, names=()):
    """Markdown of the named sections, all without names. ReportError: the results cannot be read."""
    results = read_results(directory)
    chosen = [name for name in SECTIONS if not names or name in names]
    return "\n".join([head(results)] + [SECTIONS[name](results) for name in chosen])


def main(arguments):
    if not arguments or any(name not in SECTIONS for name in arguments[1:]):
        sys.exit(__doc__)
    try:
        print(summary(pathlib.Path(arguments[0]), arguments[1:]))
    except ReportError as error:
        sys.exit(f"summary.py: {error}")


if __name__ == "__main__":
    main(sys.argv[1:])
